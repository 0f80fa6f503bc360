"use strict";
(() => {
  const all = (query, root = document) => [...root.querySelectorAll(query)];

  // Source and rows: a key such as 0-43 is file and line.
  const lines = new Map(all(".lines li").map((line) => [line.dataset.key, line]));
  const rows = all(".rows button").map((button) => ({ button, keys: button.dataset.rows.split(" ").filter(Boolean) }));
  const told = document.getElementById("chosen");

  const letGo = () => {
    all(".lines .on, .rows .on").forEach((one) => one.classList.remove("on"));
    all("#source [aria-pressed=true]").forEach((one) => one.setAttribute("aria-pressed", "false"));
    told.textContent = "";
  };
  const pick = (button, work) => {
    const again = button.getAttribute("aria-pressed") === "true";
    letGo();
    if (again) return;
    button.setAttribute("aria-pressed", "true");
    work();
  };
  const show = (one) => {
    const frame = one.closest(".source, .rows");
    const inside = one.getBoundingClientRect();
    const outside = frame.getBoundingClientRect();
    if (inside.top < outside.top || inside.bottom > outside.bottom) frame.scrollTop += inside.top - outside.top - 40;
  };
  const light = (ones) => {
    ones.forEach((one) => one.classList.add("on"));
    if (ones.length) show(ones[0]);
  };
  all(".lines button").forEach((button) =>
    button.addEventListener("click", () =>
      pick(button, () => {
        const key = button.dataset.line;
        const found = rows.filter((row) => row.keys.includes(key));
        light([lines.get(key)]);
        light(found.map((row) => row.button.parentElement));
        told.textContent = `${button.getAttribute("aria-label")}: ${found.map((r) => r.button.firstChild.textContent).join(", ")}`;
      })));
  rows.forEach(({ button, keys }) =>
    button.addEventListener("click", () =>
      pick(button, () => {
        light([button.parentElement]);
        light(keys.map((key) => lines.get(key)).filter(Boolean));
        const numbers = keys.map((key) => key.split("-")[1]).join(", ");
        told.textContent = `row ${button.firstChild.textContent}: ${numbers ? `line ${numbers}` : "no line of the source"}`;
      })));

  // Modes: one node and its arrows.
  const graph = document.querySelector(".graph");
  const modeRows = all("#modes-table tbody tr");
  if (graph) {
    all(".node", graph).forEach((node, place) => {
      node.setAttribute("tabindex", "0");
      node.setAttribute("role", "button");
      node.setAttribute("aria-label", `mode ${node.dataset.mode}`);
      const choose = () => {
        const again = node.classList.contains("on");
        all(".on", graph).concat(modeRows).forEach((one) => one.classList.remove("on"));
        graph.classList.toggle("picked", !again);
        if (again) return;
        node.classList.add("on");
        modeRows[place].classList.add("on");
        all(".edge", graph)
          .filter((edge) => [edge.dataset.from, edge.dataset.to].includes(node.dataset.mode))
          .forEach((edge) => edge.classList.add("on"));
      };
      node.addEventListener("click", choose);
      node.addEventListener("keydown", (event) => {
        if (event.key === "Enter" || event.key === " ") {
          event.preventDefault();
          choose();
        }
      });
    });
  }

  // Traces: a cursor through all charts, and the numbers below it.
  const holder = document.getElementById("run-data");
  if (!holder) return;
  const run = JSON.parse(holder.textContent);
  const readout = document.getElementById("readout");
  const charts = all("#run .chart");
  let at = -1;
  const word = (value) => (value === null || value === undefined ? "-" : String(Number(value.toPrecision(6))));
  const nearest = (t) => {
    let low = 0;
    let high = run.t.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (run.t[middle] <= t) low = middle;
      else high = middle;
    }
    return t - run.t[low] <= run.t[high] - t ? low : high;
  };
  const first = run.t[0];
  const length = run.t[run.t.length - 1] - first || 1;
  const place = (chart, t) => {
    const [left, right] = [Number(chart.dataset.left), Number(chart.dataset.right)];
    return left + ((right - left) * (t - first)) / length;
  };
  const move = (k) => {
    at = Math.max(0, Math.min(run.t.length - 1, k));
    for (const chart of charts) {
      let cursor = chart.querySelector(".cursor");
      if (!cursor) {
        cursor = document.createElementNS("http://www.w3.org/2000/svg", "line");
        cursor.setAttribute("class", "cursor");
        cursor.setAttribute("y1", chart.dataset.top);
        cursor.setAttribute("y2", chart.dataset.bottom);
        chart.append(cursor);
      }
      const x = String(place(chart, run.t[at]));
      cursor.setAttribute("x1", x);
      cursor.setAttribute("x2", x);
    }
    const values = run.signals.map((s) => `${s.name} = ${word(s.values[at])}${s.unit ? ` ${s.unit}` : ""}`);
    readout.textContent = [`t = ${word(run.t[at])}`, ...values].join(",  ");
  };
  for (const chart of charts) {
    chart.addEventListener("pointermove", (event) => {
      const box = chart.getBoundingClientRect();
      const x = ((event.clientX - box.left) / box.width) * chart.viewBox.baseVal.width;
      const [left, right] = [Number(chart.dataset.left), Number(chart.dataset.right)];
      move(nearest(first + (length * (x - left)) / (right - left)));
    });
    chart.parentElement.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10, Home: -Infinity, End: Infinity }[event.key];
      if (step === undefined) return;
      event.preventDefault();
      move(at < 0 ? 0 : at + step);
    });
  }
})();
