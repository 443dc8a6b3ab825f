"use strict";
// The field of the curves, as charts.py lays it out.
const [LEFT, RIGHT, TOP, BOTTOM] = BOX, WIDTH = SIZE[0];
const MOST_READOUTS = 4;

const sections = [...document.querySelectorAll("section.case")];
for (const section of sections) begin(section);
contents();
document.querySelectorAll(".scroll table, .preface table").forEach(sortable);
document.querySelectorAll("svg.chart").forEach(zoomable);
document.querySelector(".zoom .close").addEventListener("click", () => document.querySelector("dialog.zoom").close());

// ---- where one is: headings of the first level, of the case that is looked at
function contents() {
  const nav = document.querySelector(".contents");
  for (const [k, section] of sections.entries()) {
    for (const [n, heading] of section.querySelectorAll("h3").entries()) {
      heading.id = `part${k}-${n}`;
      const link = document.createElement("a");
      link.href = `#${heading.id}`;
      link.textContent = heading.textContent;
      link.dataset.case = k;
      nav.append(link);
    }
  }
  if (sections.length < 2) return;
  const watcher = new IntersectionObserver((entries) => {
    const seen = entries.find((entry) => entry.isIntersecting);
    if (!seen) return;
    const k = String(sections.indexOf(seen.target));
    for (const link of nav.children) link.classList.toggle("off", link.dataset.case !== k);
  }, {rootMargin: "-45% 0px -45% 0px"});
  for (const link of nav.children) link.classList.toggle("off", link.dataset.case !== "0");
  sections.forEach((section) => watcher.observe(section));
}

// ---- a click on a head sorts its table; numbers by size, what has none at the end
function sortable(table) {
  const heads = [...table.querySelectorAll("thead th")], body = table.tBodies[0];
  if (!body || body.rows.length < 2) return;
  const numberOf = (cell) => { const found = cell.textContent.replace("\u2212", "-").match(/-?\d+(\.\d+)?(e[+-]?\d+)?/); return found ? Number(found[0]) : NaN; };
  heads.forEach((head, k) => {
    head.classList.add("sorts");
    head.tabIndex = 0;
    const sort = () => {
      const falling = head.getAttribute("aria-sort") === "ascending";
      const rows = [...body.rows], keys = new Map(rows.map((row) => [row, numberOf(row.cells[k])]));
      const numeric = rows.filter((row) => !Number.isNaN(keys.get(row))).length > rows.length / 2 && k > 0;
      rows.sort((a, b) => {
        if (!numeric) return a.cells[k].textContent.localeCompare(b.cells[k].textContent) * (falling ? -1 : 1);
        const [x, y] = [keys.get(a), keys.get(b)];
        if (Number.isNaN(x) || Number.isNaN(y)) return Number.isNaN(x) - Number.isNaN(y);
        return falling ? y - x : x - y;
      });
      heads.forEach((one) => one.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", falling ? "descending" : "ascending");
      body.append(...rows);
    };
    head.addEventListener("click", sort);
    head.addEventListener("keydown", (event) => { if (event.key === "Enter") sort(); });
  });
}

// ---- a double click shows a chart large; there the wheel zooms and a drag moves
function zoomable(svg) {
  svg.addEventListener("dblclick", () => {
    const dialog = document.querySelector("dialog.zoom"), place = dialog.querySelector("div");
    const copy = svg.cloneNode(true), whole = copy.getAttribute("viewBox").split(" ").map(Number);
    let view = [...whole];
    const set = () => copy.setAttribute("viewBox", view.join(" "));
    const at = (event) => { const box = copy.getBoundingClientRect(); return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height]; };
    copy.addEventListener("wheel", (event) => {
      event.preventDefault();
      const [x, y] = at(event), factor = Math.exp(event.deltaY / 500);
      const width = Math.min(whole[2], view[2] * factor), height = width * whole[3] / whole[2];
      view = [view[0] + x * (view[2] - width), view[1] + y * (view[3] - height), width, height];
      set();
    }, {passive: false});
    let held = null;
    copy.addEventListener("pointerdown", (event) => { held = at(event); copy.setPointerCapture(event.pointerId); });
    copy.addEventListener("pointermove", (event) => {
      if (!held) return;
      const now = at(event);
      view[0] -= (now[0] - held[0]) * view[2];
      view[1] -= (now[1] - held[1]) * view[3];
      held = now;
      set();
    });
    copy.addEventListener("pointerup", () => { held = null; });
    copy.addEventListener("dblclick", () => { view = [...whole]; set(); });
    place.replaceChildren(copy);
    dialog.showModal();
  });
}

function begin(section) {
  const start = Number(section.dataset.start), end = Number(section.dataset.end);
  const slider = section.querySelector(".timebar input"), clock = section.querySelector("output");
  const frame = section.querySelector("iframe");
  const tip = document.querySelector(".value"), runs = section.querySelector(".play");
  const times = JSON.parse(section.querySelector("script.times").textContent);
  const seen = new Set(), curves = new Map();
  let time = start, asked = false, started = false, echoes = 0;

  // ---- one chart at one time
  function curvesOf(svg) {
    if (curves.has(svg)) return curves.get(svg);
    const lines = [...svg.querySelectorAll("polyline")], quiet = lines.length > MOST_READOUTS;
    const made = lines.map((line) => {
      const numbers = line.getAttribute("points").split(/[ ,]/).map(Number);
      const dot = document.createElementNS(svg.namespaceURI, "circle");
      dot.setAttribute("r", 3.4);
      dot.setAttribute("class", line.getAttribute("class"));
      svg.querySelector(".dots").append(dot);
      let text = null;
      if (svg.classList.contains("time") && (!quiet || line.classList.contains("ink"))) {
        text = document.createElementNS(svg.namespaceURI, "tspan");
        text.setAttribute("class", line.getAttribute("class"));
        svg.querySelector(".readout").append(text);
      }
      const x = numbers.filter((_, k) => k % 2 === 0), y = numbers.filter((_, k) => k % 2 === 1);
      return {x, y, dot, text, line, profile: Number(line.dataset.profile)};
    });
    curves.set(svg, made);
    return made;
  }

  // Place of a value in rising values: the index before it and the share of the way to the next; at a step its right side.
  function place(values, value) {
    let low = 0, high = values.length - 1;
    if (value >= values[high]) return [high - 1, 1];
    if (value <= values[0]) return [0, 0];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (values[middle] <= value) low = middle; else high = middle;
    }
    return [low, (value - values[low]) / (values[high] - values[low])];
  }

  const mixed = (values, [k, share]) => values[k] + share * (values[k + 1] - values[k]);

  function draw(svg) {
    const x = LEFT + (RIGHT - LEFT) * (time - start) / (end - start);
    const cursor = svg.querySelector(".cursor");
    if (cursor) { cursor.setAttribute("x1", x); cursor.setAttribute("x2", x); }
    for (const curve of curvesOf(svg)) {
      const at = cursor ? place(curve.x, x) : place(times[curve.profile], time);
      const y = mixed(curve.y, at);
      curve.dot.setAttribute("cx", mixed(curve.x, at));
      curve.dot.setAttribute("cy", y);
      if (curve.text) {
        const low = Number(svg.dataset.low), high = Number(svg.dataset.high);
        const value = low + (BOTTOM - y) / (BOTTOM - TOP) * (high - low);
        // As many digits as a place in the picture is worth.
        const digits = Math.max(0, Math.min(6, Math.ceil(3 - Math.log10(high - low) - 1)));
        curve.text.textContent = value.toFixed(digits).replace(/^-(?=0(\.0*)?$)/, "").replace("-", "\u2212") + "\u2003";
      }
    }
  }

  // ---- one time for everything
  function show(t) {
    time = Math.min(Math.max(t, start), end);
    slider.value = time;
    slider.setAttribute("aria-valuetext", time.toFixed(2) + " s");
    clock.textContent = time.toFixed(2) + " s";
    section.dataset.time = time;
    section.classList.add("live");
    if (!asked) {
      asked = true;
      requestAnimationFrame(() => { asked = false; seen.forEach(draw); });
    }
  }

  function tell(message) {
    if (!started) return;
    if (message.replay === "seek") echoes += 1;
    frame.contentWindow.postMessage(message, "*");
  }

  if (runs) runs.addEventListener("click", () => tell({replay: runs.dataset.playing === "yes" ? "pause" : "play"}));

  function seek(t) {
    show(t);
    tell({replay: "seek", time});
  }

  slider.addEventListener("input", () => seek(Number(slider.value)));
  for (const svg of section.querySelectorAll("svg.chart.time")) {
    const at = (event) => {
      const box = svg.getBoundingClientRect();
      const x = (event.clientX - box.left) / box.width * WIDTH;
      seek(start + (x - LEFT) / (RIGHT - LEFT) * (end - start));
    };
    svg.addEventListener("pointerdown", (event) => { if (event.button === 0) { svg.setPointerCapture(event.pointerId); at(event); } });
    svg.addEventListener("pointermove", (event) => { if (svg.hasPointerCapture(event.pointerId)) at(event); });
    svg.addEventListener("pointermove", (event) => { if (!svg.hasPointerCapture(event.pointerId)) hover(svg, event); });
    svg.addEventListener("pointerleave", () => { tip.hidden = true; });
  }

  // ---- values under the pointer
  function hover(svg, event) {
    const box = svg.getBoundingClientRect(), x = (event.clientX - box.left) / box.width * WIDTH;
    if (x < LEFT || x > RIGHT || event.pointerType === "touch") { tip.hidden = true; return; }
    const low = Number(svg.dataset.low), high = Number(svg.dataset.high);
    const lines = curvesOf(svg).filter((curve) => !curve.line.classList.contains("off")).map((curve) => {
      const value = low + (BOTTOM - mixed(curve.y, place(curve.x, x))) / (BOTTOM - TOP) * (high - low);
      const label = curve.line.querySelector("title");
      return `${Number(value.toPrecision(4))}  ${label ? label.textContent : ""}`;
    });
    tip.textContent = [`t = ${(start + (x - LEFT) / (RIGHT - LEFT) * (end - start)).toFixed(3)} s`, ...lines].join("\n");
    tip.hidden = false;
    tip.style.left = `${Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 4)}px`;
    tip.style.top = `${Math.max(4, event.clientY - tip.offsetHeight - 10)}px`;
  }

  // ---- profiles on and off, in charts, bars and replay
  for (const button of section.querySelectorAll(".series button")) {
    button.addEventListener("click", () => {
      const shown = button.getAttribute("aria-pressed") !== "true", k = button.dataset.profile;
      button.setAttribute("aria-pressed", shown);
      section.querySelectorAll(`.charts:not(.own) polyline[data-profile="${k}"], .governing polyline[data-profile="${k}"], .bar[data-profile="${k}"]`)
        .forEach((one) => one.classList.toggle("off", !shown));
      for (const made of curves.values()) for (const curve of made) curve.dot.classList.toggle("off", curve.line.classList.contains("off"));
      tell({replay: "show", motion: Number(k), shown});
    });
  }

  addEventListener("message", (event) => {
    if (!frame || event.source !== frame.contentWindow || !event.data) return;
    if (event.data.replay === "still" && /^data:image\/png;base64,/.test(event.data.image)) {
      const picture = section.querySelector(".snapshot");
      picture.src = event.data.image;
      picture.hidden = false;
    }
    if (event.data.replay !== "time") return;
    if (runs) {
      runs.dataset.playing = event.data.playing ? "yes" : "no";
      runs.textContent = event.data.playing ? "\u275A\u275A" : "\u25B6";
      runs.setAttribute("aria-label", event.data.playing ? "pause" : "play");
    }
    if (!started) {
      started = true;
      frame.dataset.ready = "yes";
      seek(time);
      setTimeout(() => tell({replay: "still"}), 300);  // for paper
    } else if (echoes > 0) {
      echoes -= 1;  // the answer to our own seek, which may be older than where the cursor is by now
    } else if (Number.isFinite(event.data.time)) {
      show(event.data.time);
    }
  });

  // ---- what is not in view costs nothing
  const watcher = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (entry.isIntersecting) { seen.add(entry.target); draw(entry.target); } else seen.delete(entry.target);
    }
  }, {rootMargin: "200px"});
  section.querySelectorAll("svg.chart:not(.still, .bars)").forEach((svg) => watcher.observe(svg));
  if (frame) {
    const opener = new IntersectionObserver((entries) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      opener.disconnect();
      frame.srcdoc = JSON.parse(document.getElementById(frame.dataset.replay).textContent);
    });
    opener.observe(frame);
  }
}

addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((one) => { one.open = true; }));
