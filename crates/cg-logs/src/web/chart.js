"use strict";
const NONE = "–";
const G = 9.80665, DEGREES = 180 / Math.PI;

// Creation of elements. All texts are inserted as text, so no name or message can become markup.
function make(name, attributes = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}
function draw(name, attributes = {}, text = null) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== null) node.textContent = text;
  return node;
}
const present = (value) => value !== null && value !== undefined;
const fixed = (value, digits, unit = "") => present(value) ? value.toFixed(digits) + unit : NONE;

// A linear map from data to plot coordinates, with round tick values.
function scale(low, high, from, to) {
  if (!(high > low)) { low -= 0.5; high += 0.5; }
  const at = (value) => from + (value - low) / (high - low) * (to - from);
  const rough = (high - low) / 4, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= rough);
  const marks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) marks.push(k * step);
  const digits = Math.max(0, -Math.floor(Math.log10(step)));
  return { at, marks, label: (value) => value.toFixed(digits).replace(/^-(0\.?0*)$/, "$1") };
}
function extent(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) if (present(value)) { low = Math.min(low, value); high = Math.max(high, value); }
  const margin = 0.06 * (high - low) || 0.05;
  return [low - margin, high + margin];
}
const WIDTH = 460, LEFT = 44, RIGHT = 8, TOP = 16, BOTTOM = 30;
function axes(width, height, x, y, title, unit, under = "time, s") {
  const svg = draw("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title });
  for (const mark of y.marks) {
    svg.append(draw("line", { class: "axis", x1: LEFT, x2: width - RIGHT, y1: y.at(mark), y2: y.at(mark) }));
    svg.append(draw("text", { x: LEFT - 5, y: y.at(mark) + 4, "text-anchor": "end" }, y.label(mark)));
  }
  for (const mark of x ? x.marks : []) {
    svg.append(draw("text", { x: x.at(mark), y: height - BOTTOM + 14, "text-anchor": "middle" }, x.label(mark)));
  }
  if (x) svg.append(draw("text", { x: width - RIGHT, y: height - 3, "text-anchor": "end" }, under));
  svg.append(draw("text", { x: 2, y: 10 }, unit));
  svg.append(draw("path", { class: "frame", d: `M${LEFT} ${TOP}V${height - BOTTOM}H${width - RIGHT}` }));
  return svg;
}
function line(svg, x, y, times, values, name) {
  let path = "", pen = "M";
  values.forEach((value, k) => {
    if (!present(value) || !present(times[k])) { pen = "M"; return; }
    path += `${pen}${x.at(times[k]).toFixed(1)} ${y.at(value).toFixed(1)}`;
    pen = "L";
  });
  svg.append(draw("path", { class: name, d: path }));
}
