"use strict";
(async () => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const byId = (id) => document.getElementById(id);
  const reach = data.end - data.start;

  function make(tag, where, text, kind) {
    const element = document.createElement(tag);
    if (text !== undefined) element.textContent = text;  // never as markup: names come from files
    if (kind) element.className = kind;
    where.append(element);
    return element;
  }

  async function unpacked(id) {
    const bytes = Uint8Array.from(atob(byId(id).textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  // Colours as Python mixes them.
  const channels = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
  const stops = data.utilisation_colours.map(channels);
  function colourOf(used) {
    const x = Math.min(Math.max(used, 0), 1) * (stops.length - 1), k = Math.min(Math.floor(x), stops.length - 2);
    return `rgb(${stops[k].map((c, n) => Math.round(c + (stops[k + 1][n] - c) * (x - k))).join(",")})`;
  }

  // Value of a sampled curve, straight between samples.
  function at(times, values, t) {
    let low = 0, high = times.length - 1;
    if (t <= times[0]) return values[0];
    if (t >= times[high]) return values[high];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t) low = middle; else high = middle;
    }
    return values[low] + (values[high] - values[low]) * (t - times[low]) / (times[high] - times[low]);
  }

  const swatches = [];
  const swatch = (element, motion) => swatches.push([element, motion]);

  // ---- what stands still: headings, legends, flags
  const seconds = (t) => t.toFixed(2) + " s";
  byId("title").textContent = data.title;
  const several = data.motions.length > 1;
  const toggles = data.motions.map((motion, k) => {
    const box = make("div", byId("motions"), undefined, "motion");
    const label = make("label", box);
    const toggle = make("input", label);
    toggle.type = "checkbox";
    toggle.checked = true;
    if (several) swatch(make("span", label, undefined, "swatch"), motion);
    else toggle.hidden = true;
    make("span", label, motion.label + (several ? (k ? " (ghost)" : " (solid)") : ""));
    make("p", box, motion.verdict, !motion.feasible ? "bad" : motion.doubtful ? "doubtful" : "good");
    if (motion.payload) make("p", box, "carries " + motion.payload);
    return toggle;
  });
  byId("torque-scale").style.background = `linear-gradient(90deg, ${data.utilisation_colours.join(",")})`;
  byId("fastest").textContent = data.fastest.toPrecision(3) + " m/s";

  const bars = [];
  byId("bars").style.setProperty("--names", Math.min(15, Math.max(...data.motions.flatMap((m) => m.joints).map((name) => name.length))) + "ch");
  const joints = [...new Set(data.motions.flatMap((motion) => motion.joints))];
  for (const joint of joints) {
    const line = make("div", byId("bars"), undefined, "joint");
    make("b", line, joint).title = joint;
    const row = make("div", line);
    for (const motion of data.motions) {
      const j = motion.joints.indexOf(joint);
      if (j < 0) continue;
      const bar = make("div", row, undefined, "bar"), used = motion.used[j];
      if (several) swatch(make("div", bar, undefined, "who"), motion);
      const track = make("div", bar, undefined, "track");
      const fill = make("div", track, undefined, "fill"), number = make("span", bar);
      bar.dataset.joint = joint;
      if (used === null) { number.textContent = "no limit known"; continue; }
      const peak = make("div", track, undefined, "peak"), most = used.reduce((a, b) => Math.max(a, b), 0);
      peak.style.left = `calc(${100 * Math.min(most, 1)}% - 2px)`;
      peak.title = `most: ${(100 * most).toFixed(0)} %`;
      bars.push({times: motion.times, used, fill, number});
    }
  }

  const flags = data.motions.flatMap((motion) => motion.flags.map((flag) => ({...flag, motion})));
  const lanes = Math.max(1, Math.min(6, flags.filter((flag) => flag.kind === "limit").length));
  byId("spans").style.height = 4 * lanes + "px";
  for (const [n, flag] of flags.entries()) {
    const button = make("button", make("li", byId("flags")));
    button.type = "button";
    make("span", button, undefined, "sign " + flag.kind);
    make("time", button, seconds(flag.time));
    const during = flag.spans.map(([a, b]) => `${a.toFixed(2)} to ${b.toFixed(2)} s`).join(", ");
    make("span", button, (several ? flag.motion.label + ": " : "") + flag.text + (during ? " (" + during + ")" : ""));
    button.addEventListener("click", () => { pause(); seek(flag.time); });
    for (const [a, b] of flag.spans.length ? flag.spans : [[flag.time, flag.time]]) {
      const mark = make("i", byId("spans"));
      mark.style.left = `${100 * (a - data.start) / reach}%`;
      mark.style.width = `${100 * (b - a) / reach}%`;
      mark.style.top = flag.kind === "limit" ? 4 * Math.min(n, lanes - 1) + "px" : "0";
      mark.style.height = flag.kind === "limit" ? "3px" : "100%";
      mark.style.background = flag.kind === "limit" ? "#d61a1c" : "#85339e";
    }
  }
  if (!flags.length) make("li", byId("flags"), "no violated limit, no singular posture");
  for (const missing of new Set(data.motions.flatMap((motion) => motion.missing))) {
    byId("notes-box").hidden = false;
    make("li", byId("notes"), "not drawn: " + missing);
  }

  // ---- the clock
  let time = data.start, playing = false, last = 0, viewer = null, stage = null;
  const listeners = [];
  const slider = byId("time");
  slider.min = data.start;
  slider.max = data.end;

  function seek(t) {
    time = Math.min(Math.max(t, data.start), data.end);
    slider.value = time;
    byId("clock").textContent = `${time.toFixed(2)} of ${data.end.toFixed(2)} s`;
    slider.setAttribute("aria-valuetext", seconds(time));
    for (const bar of bars) {
      const used = at(bar.times, bar.used, time), percent = 100 * used;
      bar.fill.style.width = Math.min(percent, 100) + "%";
      bar.fill.style.background = colourOf(used);
      bar.number.textContent = (percent > 100 ? "! " : "") + percent.toFixed(0) + " %";
      bar.number.className = percent > 100 ? "over" : "";
    }
    const first = data.motions[0];
    byId("tool-speed").textContent = at(first.times, first.speed, time).toFixed(2) + " m/s now";
    byId("singular-now").textContent = "from singular: " + first.singular
      .map(one => `${one.kind} ${Math.abs(at(first.times, one.apart, time)).toFixed(3)}`).join(", ");
    if (viewer) viewer.animator.seek(time - data.start);
    for (const listener of listeners) listener(time);
  }

  function play() {
    if (time >= data.end) seek(data.start);
    playing = true;
    last = performance.now();
    byId("play").textContent = "\u275A\u275A";
    byId("play").setAttribute("aria-label", "pause");
  }

  function pause() {
    const was = playing;
    playing = false;
    byId("play").textContent = "\u25B6";
    byId("play").setAttribute("aria-label", "play");
    if (was) for (const listener of listeners) listener(time);
  }

  function tick(now) {
    requestAnimationFrame(tick);
    if (playing) {
      const next = time + Math.max(0, now - last) / 1000 * Number(byId("speed").value);
      last = now;
      if (next < data.end) seek(next);
      else if (byId("repeat").checked) seek(data.start);
      else { seek(data.end); pause(); }
    }
    if (stage) stage.step();
    placeLabels();
  }

  byId("play").addEventListener("click", () => playing ? pause() : play());
  slider.addEventListener("input", () => { pause(); seek(Number(slider.value)); });
  slider.addEventListener("keydown", (event) => {
    const steps = {ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10};
    if (event.key in steps) { event.preventDefault(); pause(); seek(time + steps[event.key] * reach / 200); }
  });
  // ---- view, pictures, keys
  const press = (id, on) => byId(id).setAttribute("aria-pressed", on);
  const does = {
    follow() { stage.follow(!stage.following); press("follow", stage.following); },
    night() { paint(!stage.dark); },
    png() { save(snapshot(), "replay.png"); },
    video() { if (recording) recording = null; else video(); },
    full() { document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen().catch(() => {}); },
  };
  for (const id of Object.keys(does)) byId(id).addEventListener("click", () => { if (stage) does[id](); });
  for (const button of document.querySelectorAll("[data-look]")) button.addEventListener("click", () => look(button.dataset.look));

  function look(name) {
    if (!stage) return;
    stage.follow(false);
    press("follow", false);
    stage.look(name);
  }

  function paint(isDark) {
    theme(isDark);
    const fine = stage.paint(isDark);
    press("night", isDark);
    byId("scale").textContent = `; squares of ${fine} m`;
  }

  function theme(isDark) {
    document.documentElement.dataset.theme = isDark ? "dark" : "light";
    for (const [element, motion] of swatches) element.style.background = motion.colours[isDark ? 1 : 0];
  }

  const caption = () => `${data.title}, t = ${seconds(time)}`;

  function snapshot() {
    const canvas = document.createElement("canvas");
    stage.drawOn(canvas, caption());
    return canvas.toDataURL("image/png");
  }

  function save(address, name) {
    const link = document.createElement("a");
    link.href = address;
    link.download = `${data.title.replace(/[^A-Za-z0-9_-]+/g, "-").slice(0, 60)}-${name}`;
    link.click();
  }

  // One run from start to end, frame by frame on a canvas of its own: complete on a slow machine too, if then slower.
  const FRAMES = 30, later = (wait) => new Promise((done) => setTimeout(done, wait));
  let recording = null;
  async function video() {
    const canvas = document.createElement("canvas"), parts = [], before = time;
    const kind = ["video/webm;codecs=vp9", "video/webm", "video/mp4"].find((one) => window.MediaRecorder && MediaRecorder.isTypeSupported(one));
    if (!kind || !canvas.captureStream) { byId("hint").textContent = "this browser does not record video"; return; }
    pause();
    canvas.className = "film";  // only what is in the page is filmed
    document.body.append(canvas);
    stage.drawOn(canvas, caption());
    recording = new MediaRecorder(canvas.captureStream(FRAMES), {mimeType: kind, videoBitsPerSecond: 8e6});
    const recorder = recording, stopped = new Promise((done) => { recorder.onstop = done; });
    recorder.ondataavailable = (event) => parts.push(event.data);
    press("video", true);
    byId("video").textContent = "stop";
    recorder.start();
    await later(200);  // until the recorder listens
    const step = Number(byId("speed").value) / FRAMES;
    for (let t = data.start; recording && t < data.end + step; t += step) {
      const begun = performance.now();
      seek(t);
      stage.step();
      placeLabels();
      stage.drawOn(canvas, caption());
      await later(Math.max(8, 1000 / FRAMES - (performance.now() - begun)));
    }
    await later(300);  // until the last frames have come through
    recorder.stop();
    await stopped;
    recording = null;
    canvas.remove();
    press("video", false);
    byId("video").textContent = "video";
    const address = URL.createObjectURL(new Blob(parts, {type: kind}));
    save(address, kind.startsWith("video/mp4") ? "replay.mp4" : "replay.webm");
    setTimeout(() => URL.revokeObjectURL(address), 60000);
    seek(before);
  }

  const keys = {
    " ": () => playing ? pause() : play(),
    ArrowLeft: () => { pause(); seek(time - reach / 200); },
    ArrowRight: () => { pause(); seek(time + reach / 200); },
    Home: () => { pause(); seek(data.start); },
    End: () => { pause(); seek(data.end); },
    1: () => look("home"), 2: () => look("front"), 3: () => look("side"), 4: () => look("top"),
    t: () => byId("follow").click(), d: () => byId("night").click(), p: () => byId("png").click(),
    v: () => byId("video").click(), f: () => byId("full").click(),
    l: () => { byId("repeat").checked = !byId("repeat").checked; },
  };
  addEventListener("keydown", (event) => {
    const typing = ["INPUT", "SELECT"].includes(event.target.tagName) || event.ctrlKey || event.metaKey || event.altKey;
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act || typing || (event.key === " " && event.target.tagName === "BUTTON")) return;
    event.preventDefault();
    act();
  });

  // ---- names of the via points of the first motion, over the picture
  const labels = data.motions[0].vias.map(([t, x, y, z], k) => ({
    point: [x, z, -y], element: make("span", byId("labels"), `${data.point_names[k] || k + 1}: ${seconds(t)}`),
  }));

  function placeLabels() {
    if (!viewer) return;
    const pane = byId("pane"), width = pane.clientWidth, height = pane.clientHeight;
    viewer.camera.updateMatrixWorld();
    for (const label of labels) {
      const at = new MeshCat.THREE.Vector3(...label.point).project(viewer.camera);
      label.element.hidden = at.z > 1 || !toggles[0].checked;
      const x = Math.min((at.x + 1) / 2 * width + 9, width - label.element.offsetWidth - 2);
      label.element.style.transform = `translate(${x}px, ${(1 - at.y) / 2 * height - 20}px)`;
    }
  }

  // ---- the viewer
  function started(commands) {
    const pane = byId("pane");
    const made = new MeshCat.Viewer(pane);
    // Meshcat takes the window's height for its own.
    made.set_3d_pane_size = function () {
      this.camera.aspect = pane.clientWidth / Math.max(1, pane.clientHeight);
      // Keep the width of the scene in view on a narrow screen.
      this.camera.fov = this.camera.aspect < 1 ? 2 * Math.atan(Math.tan(Math.PI / 9) / this.camera.aspect) * 180 / Math.PI : 40;
      this.camera.updateProjectionMatrix();
      this.renderer.setSize(pane.clientWidth, pane.clientHeight);
      this.set_dirty();
    };
    made.set_3d_pane_size();
    new ResizeObserver(() => made.set_3d_pane_size()).observe(pane);
    const view = new DataView(commands.buffer);
    for (let k = 0; k < commands.length;) {
      const size = view.getUint32(k, true);
      made.handle_command_bytearray(commands.slice(k + 4, k + 4 + size));
      k += 4 + size;
    }
    made.animator.play();   // makes the actions take part;
    made.animator.pause();  // the clock is ours
    data.motions.forEach((_, k) => toggles[k].addEventListener("change", () => {
      made.scene_tree.find(["meshcat", `motion${k}`]).object.visible = toggles[k].checked;
      made.set_dirty();
    }));
    return made;
  }

  const isDark = matchMedia("(prefers-color-scheme: dark)").matches;
  theme(isDark);
  try {
    if (typeof DecompressionStream === "undefined") throw new Error("it is too old to unpack this file");
    const [code, scene] = await Promise.all([unpacked("viewer"), unpacked("scene")]);
    const script = document.createElement("script");
    script.textContent = new TextDecoder().decode(code);
    document.head.append(script);
    window.onmessage = null;  // a recorder in there takes every message for its own
    viewer = started(scene);
    stage = dressed(viewer, data, byId("pane"));
    stage.look("home");
    paint(isDark);
    byId("loading").hidden = true;
  } catch (error) {
    byId("loading").hidden = true;
    byId("problem").hidden = false;
    byId("problem").textContent = `This browser cannot draw the arm: ${error.message}. The numbers beside it still hold.`;
  }

  // ---- for the page around, and for whoever looks into this one
  window.replay = {
    seek, play, pause, viewer, stage, look, snapshot,
    get time() { return time; },
    get playing() { return playing; },
    onTime: (listener) => listeners.push(listener),
  };
  if (window.parent !== window) {
    listeners.push((t) => window.parent.postMessage({replay: "time", time: t, playing}, "*"));
    addEventListener("message", (event) => {
      if (event.source !== window.parent || !event.data || typeof event.data !== "object") return;
      if (event.data.replay === "seek" && Number.isFinite(event.data.time)) { pause(); seek(event.data.time); }
      if (event.data.replay === "play") play();
      if (event.data.replay === "pause") pause();
      if (event.data.replay === "show" && toggles[event.data.motion]) {
        toggles[event.data.motion].checked = Boolean(event.data.shown);
        toggles[event.data.motion].dispatchEvent(new Event("change"));
      }
      // Hidden, as on paper, it has no size and no picture.
      const isSeen = byId("pane").clientWidth > 0 && byId("pane").clientHeight > 0;
      if (event.data.replay === "still" && stage && isSeen) window.parent.postMessage({replay: "still", image: snapshot()}, "*");
    });
  }
  seek(data.start);
  requestAnimationFrame(tick);
  if (window.parent === window && !matchMedia("(prefers-reduced-motion: reduce)").matches) play();
  document.documentElement.dataset.ready = viewer ? "yes" : "no";
})();
