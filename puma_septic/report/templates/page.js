"use strict";
// The field of the curves, as charts.py lays it out.
const [LEFT, RIGHT, TOP, BOTTOM] = BOX, WIDTH = SIZE[0];
const MOST_READOUTS = 4;

for (const section of document.querySelectorAll("section.case")) begin(section);

function begin(section) {
  const start = Number(section.dataset.start), end = Number(section.dataset.end);
  const slider = section.querySelector(".timebar input"), clock = section.querySelector("output");
  const frame = section.querySelector("iframe");
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
      return {x, y, dot, text, profile: Number(line.dataset.profile)};
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
  }

  addEventListener("message", (event) => {
    if (!frame || event.source !== frame.contentWindow || !event.data || event.data.replay !== "time") return;
    if (!started) {
      started = true;
      frame.dataset.ready = "yes";
      seek(time);
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
