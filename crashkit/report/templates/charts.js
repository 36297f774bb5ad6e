"use strict";
// Charts are drawn when they come near the window, so that a page with many opens at once; before printing, all of them.
const CONFIG = { displayModeBar: false, responsive: true };
const PRINTED_WIDTH = 320; // pixels: two columns on A4

function draw(plot) {
  const source = plot.querySelector("script");
  if (!source) return;
  const figure = JSON.parse(source.textContent);
  source.remove();
  Plotly.newPlot(plot, figure.data, figure.layout, CONFIG);
}

function resize(plot, width) {
  Plotly.relayout(plot, { width, autosize: width === null });
}

window.addEventListener("DOMContentLoaded", () => {
  const plots = document.querySelectorAll(".plot");
  const observer = new IntersectionObserver(
    (entries) => entries.filter((entry) => entry.isIntersecting).forEach((entry) => draw(entry.target)),
    { rootMargin: "800px" },
  );
  plots.forEach((plot) => observer.observe(plot));
  window.addEventListener("beforeprint", () => plots.forEach((plot) => { draw(plot); resize(plot, PRINTED_WIDTH); }));
  window.addEventListener("afterprint", () => plots.forEach((plot) => resize(plot, null)));
});
