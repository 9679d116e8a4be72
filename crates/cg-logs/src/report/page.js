const page = JSON.parse(document.getElementById("data").textContent);
// The folder that all logs have in common; it is not shown in their names.
const folder = page.logs.map((log) => log.log.slice(0, log.log.lastIndexOf("/") + 1)).reduce((shared, one) => {
  while (!one.startsWith(shared)) shared = shared.length > 1 ? shared.slice(0, shared.lastIndexOf("/", shared.length - 2) + 1) : "";
  return shared;
});
const short = (log) => log.log.slice(folder.length);

function shade(svg, x, log, height) {
  for (const one of log.maneuvers) {
    const from = x.at(one.start_s), wide = Math.max(1, x.at(one.end_s) - from);
    svg.append(draw("rect", { class: one.status, x: from, y: TOP, width: wide, height: height - TOP - BOTTOM }));
  }
}

// The plots of a log.
// Suspension roll and specific force of a pair are drawn together: in these units their sizes are similar.
function signalPictures(log) {
  const signals = log.signals, known = signals.time_s.filter(present);
  const x = scale(Math.min(...known), Math.max(...known), LEFT, WIDTH - RIGHT);
  const degrees = (name, key, text) => [name, signals[key].map((v) => present(v) ? v * DEGREES : null), `${text}, °`];
  const tenths = (name, key, text) => [name, signals[key].map((v) => present(v) ? v / G * 10 : null), `${text}, 0.1 g`];
  const suspension = (key, unit) => [degrees("roll", `${key}suspension_roll_rad`, `suspension roll of the ${unit}`),
    tenths("lateral", `${key}lateral_specific_force_mps2`, "specific force")];
  const panels = [
    [120, [degrees("steer", "steer_rad", "steer"), tenths("lateral", "lateral_acceleration_mps2", "lateral acceleration")]],
    [130, [degrees("roll", "roll_rad", signals.to_gravity ? "roll relative to gravity" : "roll")]],
    [130, suspension("", "trailer")],
    [130, suspension("tractor_", "tractor")],
  ];
  return panels.filter(([, lines]) => lines.some(([, values]) => values.length)).map(([height, lines]) => panel(log, x, height, lines));
}
function panel(log, x, height, lines) {
  const names = lines.filter(([, values]) => values.length);
  const y = scale(...extent(names.flatMap(([, values]) => values)), height - BOTTOM, TOP);
  const svg = axes(WIDTH, height, x, y, names.map(([, , text]) => text).join(" and "), "");
  shade(svg, x, log, height);
  let at = LEFT;
  for (const [name, values, text] of names) {
    line(svg, x, y, log.signals.time_s, values, name);
    svg.append(draw("text", { class: `key ${name}`, x: at, y: 10 }, text));
    at += 24 + text.length * 6;
  }
  return svg;
}
function heightPicture(log) {
  const good = log.maneuvers.filter((one) => present(one.height_m));
  const width = WIDTH, height = 250;
  const reach = good.flatMap((one) => [one.height_m - 1.96 * one.height_sd_m, one.height_m + 1.96 * one.height_sd_m]);
  const y = scale(...extent([...reach, ...(log.height_ci95_m || []), log.known_height_m]), height - BOTTOM, TOP);
  const times = log.signals ? log.signals.time_s.filter(present) : [];
  const all = [...times, ...log.maneuvers.flatMap((one) => [one.start_s, one.end_s])];
  const x = scale(Math.min(...all), Math.max(...all), LEFT, width - RIGHT);
  const svg = axes(width, height, x, y, `Heights of ${short(log)}`, "height, m");
  if (log.height_ci95_m) {
    const [low, high] = log.height_ci95_m;
    svg.append(draw("rect", { class: "band", x: LEFT, y: y.at(high), width: width - LEFT - RIGHT, height: y.at(low) - y.at(high) }));
    svg.append(draw("path", { class: "interval", d: `M${LEFT} ${y.at(log.height_m)}H${width - RIGHT}` }));
  }
  if (present(log.known_height_m)) diamond(svg, width - RIGHT - 6, y.at(log.known_height_m));
  for (const one of good) {
    const at = x.at((one.start_s + one.end_s) / 2), sd = 1.96 * one.height_sd_m;
    svg.append(draw("path", { class: "interval", d: `M${at} ${y.at(one.height_m - sd)}V${y.at(one.height_m + sd)}` }));
    svg.append(draw("circle", { class: "dot", cx: at, cy: y.at(one.height_m), r: 3 }));
  }
  return svg;
}
function diamond(svg, x, y) {
  svg.append(draw("path", { class: "known", d: `M${x - 5} ${y}L${x} ${y - 5}L${x + 5} ${y}L${x} ${y + 5}Z` }));
}

// The details of a log, shown below its row.
function detail(log) {
  const cell = make("td", { colspan: COLUMNS.length });
  if (present(log.unreadable)) {
    cell.append(make("p", { class: "bad" }, log.unreadable));
    return make("tr", { class: "detail" }, cell);
  }
  if (log.messages.length) cell.append(make("ul", {}, ...log.messages.map((text) => make("li", {}, text))));
  const facts = `Speed ${fixed(log.speed_mps, 1, " m/s")}, trailer ${fixed(log.trailer_mass_kg, 0, " kg")}, `
    + (present(log.lift_axle) ? `lift axle ${log.lift_axle}, ` : "")
    + `channel ${log.channel || NONE}, method ${log.method}, signal-to-noise ratio ${fixed(log.snr_db, 1, " dB")}, fit ${fixed(log.fit_percent, 1, " %")}.`;
  cell.append(make("p", { class: "quiet" }, facts));
  const pair = make("div", { class: "pair" });
  if (log.signals && log.signals.time_s.length) {
    pair.append(make("div", {}, make("h3", {}, "Signals (shaded areas: maneuvers)"), ...signalPictures(log)));
  }
  if (log.maneuvers.some((one) => present(one.height_m))) {
    pair.append(make("div", {}, make("h3", {}, "Height of each maneuver (bar: 95 % interval due to noise; band: 95 % interval of the result)"), heightPicture(log)));
  }
  cell.append(pair);
  if (log.maneuvers.length) {
    const rows = log.maneuvers.map((one) => make("tr", {},
      make("td", {}, `${one.start_s.toFixed(1)} to ${one.end_s.toFixed(1)} s`),
      make("td", {}, present(one.height_m) ? `${one.height_m.toFixed(3)} ± ${one.height_sd_m.toFixed(3)} m` : NONE),
      make("td", { class: "wide" }, fixed(one.snr_db, 1, " dB")),
      make("td", one.reason ? { class: "bad" } : {}, one.reason || one.status)));
    const head = ["Maneuver", "Height ± sd due to noise", "SNR", "Status"].map((text, k) => make("th", k === 2 ? { class: "wide" } : {}, text));
    cell.append(make("table", {}, make("thead", {}, make("tr", {}, ...head)), make("tbody", {}, ...rows)));
  }
  return make("tr", { class: "detail" }, cell);
}

// The table.
const answered = page.logs.filter((log) => present(log.height_m));
const knowing = page.logs.some((log) => present(log.known_height_m));
const status = (log) => present(log.unreadable) ? "unreadable" : log.status;
const error = (log) => present(log.height_m) && present(log.known_height_m) ? 100 * (log.height_m / log.known_height_m - 1) : null;
const signed = (value) => present(value) ? (value >= 0 ? "+" : "−") + Math.abs(value).toFixed(1) + " %" : NONE;
const COLUMNS = [
  { name: "Log", sort: (log) => log.log, text: short },
  { name: "Height", sort: (log) => log.height_m, text: (log) => present(log.height_m) ? fixed(log.height_m, 3, " m") : status(log) },
  { name: "± sd", wide: true, sort: (log) => log.height_sd_m, text: (log) => fixed(log.height_sd_m, 3, " m") },
  { name: "95 % interval", wide: true, sort: (log) => log.height_ci95_m ? log.height_ci95_m[0] : null,
    text: (log) => log.height_ci95_m ? `${log.height_ci95_m[0].toFixed(2)} to ${log.height_ci95_m[1].toFixed(2)} m` : NONE },
  { name: "Rollover", sort: (log) => log.static_rollover_threshold_g, text: (log) => fixed(log.static_rollover_threshold_g, 2, " g") },
  { name: "Maneuvers", wide: true, sort: (log) => log.maneuvers ? log.maneuvers.length : null,
    text: (log) => log.maneuvers ? `${log.maneuvers.filter((one) => one.status === "ok").length} of ${log.maneuvers.length}` : NONE },
  ...(knowing ? [
    { name: "Known", wide: true, sort: (log) => log.known_height_m, text: (log) => fixed(log.known_height_m, 3, " m") },
    { name: "Error", sort: error, text: (log) => signed(error(log)) },
  ] : []),
];
const rows = page.logs.map((log, k) => {
  const cells = COLUMNS.map((column) => {
    const bad = column.name === "Height" && !present(log.height_m);
    return make("td", { class: [column.wide ? "wide" : "", bad ? "bad" : ""].join(" ").trim() }, column.text(log));
  });
  const row = make("tr", { class: "log", title: log.log, tabindex: "0", "aria-expanded": "false", id: `log-${k}` }, ...cells);
  row.addEventListener("click", () => toggle(k));
  row.addEventListener("keydown", (event) => {
    if (event.key === "Enter" || event.key === " ") { event.preventDefault(); toggle(k); }
  });
  return row;
});
const details = new Map();
function toggle(k, open = !details.has(k)) {
  if (open === details.has(k)) return;
  rows[k].classList.toggle("open", open);
  rows[k].setAttribute("aria-expanded", String(open));
  if (open) {
    details.set(k, detail(page.logs[k]));
    rows[k].after(details.get(k));
  } else {
    details.get(k).remove();
    details.delete(k);
  }
}
const body = document.querySelector("#logs tbody");
const heads = COLUMNS.map((column, place) => {
  const button = make("button", { type: "button" }, column.name);
  const head = make("th", { scope: "col", "aria-sort": "none", class: column.wide ? "wide" : "" }, button);
  button.addEventListener("click", () => sort(place));
  return head;
});
document.querySelector("#logs thead tr").append(...heads);
function sort(place) {
  const down = heads[place].getAttribute("aria-sort") === "ascending";
  heads.forEach((head, k) => head.setAttribute("aria-sort", k === place ? (down ? "descending" : "ascending") : "none"));
  const key = page.logs.map((log) => COLUMNS[place].sort(log));
  const order = page.logs.map((_, k) => k).sort((a, b) => {
    if (!present(key[a]) || !present(key[b])) return present(key[b]) - present(key[a]); // absent values are last
    const less = typeof key[a] === "string" ? key[a].localeCompare(key[b], "en", { numeric: true }) : key[a] - key[b];
    return down ? -less : less;
  });
  body.replaceChildren(...order.flatMap((k) => details.has(k) ? [rows[k], details.get(k)] : [rows[k]]));
}
body.replaceChildren(...rows);

// Heading, totals, overview.
document.title = page.title;
document.getElementById("title").textContent = page.title;
document.getElementById("about").textContent =
  `${page.calibration ? `Calibrated with ${page.calibration}` : "Not calibrated: the intervals follow from [uncertainty] in the vehicle file"}. Written ${page.written}.${folder ? ` Logs in ${folder}` : ""}`;
document.getElementById("foot").textContent =
  `cg ${page.version}. Height: center of gravity of the trailer's sprung mass above the ground at rest. Rollover: lateral acceleration above which the vehicle rolls over in a steady turn.`;
function median(values) {
  const sorted = values.filter(present).sort((a, b) => a - b), n = sorted.length;
  return n ? (sorted[(n - 1) >> 1] + sorted[n >> 1]) / 2 : null;
}
const errors = page.logs.map(error).filter(present);
const totals = [
  ["logs", String(page.logs.length)],
  ["with a height", String(answered.length)],
  ["rejected", String(page.logs.filter((log) => status(log) === "rejected").length)],
  ["inconsistent", String(page.logs.filter((log) => status(log) === "inconsistent").length)],
  ...(page.logs.some((log) => present(log.unreadable)) ? [["unreadable", String(page.logs.filter((log) => present(log.unreadable)).length)]] : []),
  ["median height", fixed(median(answered.map((log) => log.height_m)), 2, " m")],
  ["lowest rollover threshold", answered.length ? fixed(Math.min(...answered.map((log) => log.static_rollover_threshold_g).filter(present)), 2, " g") : NONE],
  ...(errors.length ? [["largest error", signed(errors.reduce((a, b) => Math.abs(b) > Math.abs(a) ? b : a))]] : []),
];
document.getElementById("totals").append(...totals.map(([name, value]) =>
  make("div", { class: "tile" }, make("b", {}, value), make("span", { class: "quiet" }, name))));
function overview() {
  const narrow = window.innerWidth <= 700, width = narrow ? 380 : 1080, height = narrow ? 220 : 240;
  const y = scale(...extent(page.logs.flatMap((log) => [log.known_height_m, ...(log.height_ci95_m || [])])), height - BOTTOM, TOP);
  const svg = axes(width, height, null, y, "Heights of all logs", "height, m");
  const step = (width - LEFT - RIGHT) / Math.max(1, page.logs.length), radius = Math.max(1.5, Math.min(4, step / 3));
  page.logs.forEach((log, k) => {
    const at = LEFT + (k + 0.5) * step;
    const dot = draw("circle", { class: "dot", cx: at, r: radius });
    if (log.height_ci95_m) {
      svg.append(draw("path", { class: "interval", d: `M${at} ${y.at(log.height_ci95_m[0])}V${y.at(log.height_ci95_m[1])}` }));
      dot.setAttribute("cy", y.at(log.height_m));
    } else {
      dot.setAttribute("class", "dot none");
      dot.setAttribute("cy", height - BOTTOM);
    }
    dot.append(draw("title", {}, `${short(log)}: ${present(log.height_m) ? fixed(log.height_m, 3, " m") : status(log)}`));
    dot.addEventListener("click", () => { toggle(k, true); rows[k].scrollIntoView({ block: "center" }); });
    if (present(log.known_height_m)) diamond(svg, at, y.at(log.known_height_m));
    svg.append(dot);
  });
  svg.append(draw("text", { x: width - RIGHT, y: height - BOTTOM + 14, "text-anchor": "end" }, `${page.logs.length} logs, in the order given`));
  document.getElementById("overview").replaceChildren(svg);
}
if (answered.length || knowing) overview(); else document.getElementById("overview").textContent = "No log gave a height.";
if (page.logs.length === 1) toggle(0, true);
