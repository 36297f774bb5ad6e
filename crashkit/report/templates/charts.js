"use strict";
// Charts are drawn when they come near the window, so that a page with many opens at once; before printing, all of them.
const CONFIG = { displayModeBar: false, responsive: true };

function draw(plot) {
  const source = plot.querySelector("script");
  if (!source) return;
  const figure = JSON.parse(source.textContent);
  source.remove();
  Plotly.newPlot(plot, figure.data, figure.layout, CONFIG);
}

const eachDrawing = (action) => document.querySelectorAll(".main-svg").forEach(action);

window.addEventListener("DOMContentLoaded", () => {
  const plots = document.querySelectorAll(".plot");
  const observer = new IntersectionObserver(
    (entries) => entries.filter((entry) => entry.isIntersecting).forEach((entry) => draw(entry.target)),
    { rootMargin: "800px" },
  );
  plots.forEach((plot) => observer.observe(plot));
  window.addEventListener("beforeprint", () => {
    plots.forEach(draw);
    // With a view box a drawing shrinks to the column of the paper.
    eachDrawing((svg) => svg.setAttribute("viewBox", `0 0 ${svg.getAttribute("width")} ${svg.getAttribute("height")}`));
  });
  window.addEventListener("afterprint", () => eachDrawing((svg) => svg.removeAttribute("viewBox")));
});
