const at = (id) => document.getElementById(id);
const show = (id, text) => { if (at(id).textContent !== text) at(id).textContent = text; };
const clock = (time) => time > 1e9 ? new Date(time * 1000).toTimeString().slice(0, 8) : `${time.toFixed(1)} s`;

// What the page knows. The history that follows each connection builds it again.
let known;
function forget() {
  known = { steps: [], messages: [], now: null, turn: null, start: null, level: 0, ended: null, drawn: null };
}
forget();

// A step of the height: it holds until the next one.
function step(time, line) {
  const last = known.steps[known.steps.length - 1];
  const interval = line.height_ci95_m;
  if (last && last.height === line.height_m && (!interval || (last.low === interval[0] && last.high === interval[1]))) return;
  if (!last && !present(line.height_m)) return;
  const [low, high] = interval || [null, null];
  known.steps.push({ time, height: line.height_m, low, high, maneuver: line.event === "maneuver" });
  // As in the history of the program: every second step of too many is left out.
  if (known.steps.length > 600) known.steps = known.steps.filter((_, k) => k % 2 === 0 || k > 598);
}
function tell(time, text, bad = false) {
  known.messages.unshift({ time, text, bad });
  known.messages.length = Math.min(known.messages.length, 40);
}
const WORDS = {
  start(line) { known.start = line; },
  state(line) { if (known.now) Object.assign(known.now, { state: line.state, missing: line.missing }); },
  status(line) { present_values(line); },
  maneuver(line) {
    step(line.time_s, line);
    if (line.status === "inconsistent") tell(line.time_s, "The channels contradict each other, so there is no height.", true);
  },
  load_changed(line) { tell(line.time_s, `Load changed: ${line.message}.`); },
  learned(line) { tell(line.time_s, `Learned from ${line.trips} trips: ${line.message}`); },
  warning(line) {
    known.level = line.level;
    const left = present(line.margin_g) ? `, ${fixed(line.margin_g, 2, " g")} left` : "";
    tell(line.time_s, line.level ? `Rollover warning, level ${line.level}${left}.` : "The rollover warning has ended.", line.level > 0);
  },
  notice(line) { tell(line.time_s, `${line.subject}: ${line.message}`); },
  stop(line) { known.ended = line; tell(line.time_s, `The estimation has ended: ${line.reason}.`); },
};
function take(line) {
  (WORDS[line.event] || (() => {}))(line);
}
function present_values(line) {
  known.now = line;
  known.level = line.warning_level;
  step(line.time_s, line);
}

// The pictures.
function gauge(now) {
  const width = WIDTH, height = 44, left = 14, threshold = now.static_rollover_threshold_g;
  if (!present(threshold)) return null;
  const used = Math.abs(now.lateral_acceleration_g || 0), x = scale(0, 1.15 * threshold, left, width - RIGHT);
  const svg = draw("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": "Lateral acceleration and rollover threshold" });
  svg.append(draw("rect", { class: "room", x: left, y: 4, width: width - RIGHT - left, height: 20, rx: 4 }));
  const length = Math.min(x.at(used), width - RIGHT) - left;
  svg.append(draw("rect", { class: now.warning_level ? "used warned" : "used", x: left, y: 4, width: length, height: 20, rx: 4 }));
  svg.append(draw("path", { class: "limit", d: `M${x.at(threshold)} 0V28` }));
  for (const mark of x.marks) svg.append(draw("text", { x: x.at(mark), y: 40, "text-anchor": "middle" }, `${x.label(mark)} g`));
  return svg;
}
function heights(now) {
  const steps = known.steps;
  if (!steps.some((one) => present(one.height))) return null;
  const end = Math.max(now ? now.time_s : -Infinity, steps[steps.length - 1].time);
  const minutes = (time) => (end - time) / 60;
  const y = scale(...extent(steps.flatMap((one) => [one.low, one.high])), 220 - BOTTOM, TOP);
  const x = scale(0, Math.max(minutes(steps[0].time), 0.1), WIDTH - RIGHT, LEFT);
  const svg = axes(WIDTH, 220, x, y, "Height over time", "m", "minutes ago");
  steps.forEach((one, k) => {
    if (!present(one.height)) return;
    const [from, to] = [one.time, k + 1 < steps.length ? steps[k + 1].time : end].map((time) => x.at(minutes(time)));
    svg.append(draw("rect", { class: "band", x: from, y: y.at(one.high), width: to - from, height: y.at(one.low) - y.at(one.high) }));
    svg.append(draw("path", { class: "interval", d: `M${from} ${y.at(one.height)}H${to}` }));
    if (one.maneuver) svg.append(draw("circle", { class: "dot", cx: from, cy: y.at(one.height), r: 3 }));
  });
  return svg;
}
function turn(one) {
  const g = one.lateral_acceleration_mps2.map((v) => v / G), roll = one.roll_rad.map((v) => v * DEGREES);
  const x = scale(...extent([...g, 0]), LEFT, WIDTH - RIGHT);
  const of = (ratio, v) => (one.roll_offset_rad + ratio * v * G) * DEGREES;
  const middle = g.reduce((sum, v) => sum + v, 0) / g.length;
  const [from, to] = [Math.min(...g, 0), Math.max(...g, 0)];
  const y = scale(...extent([...roll, ...(present(one.ratio) ? [of(one.ratio, from), of(one.ratio, to)] : [])]), 220 - BOTTOM, TOP);
  const svg = axes(WIDTH, 220, x, y, "Roll angle over lateral acceleration", "roll, °", "lateral acceleration, g");
  if (one.ratio_ci95) {
    // The lines of all heights pass through the mean of the points.
    const corner = (ratio, v) => `${x.at(v).toFixed(1)} ${y.at(of(one.ratio, middle) + ratio * (v - middle) * G * DEGREES).toFixed(1)}`;
    const [low, high] = one.ratio_ci95, apex = corner(low, middle);
    for (const end of [from, to]) {
      svg.append(draw("path", { class: "band", d: `M${apex}L${corner(low, end)}L${corner(high, end)}Z` }));
    }
  }
  g.forEach((v, k) => svg.append(draw("circle", { class: "point", cx: x.at(v).toFixed(1), cy: y.at(roll[k]).toFixed(1), r: 1.6 })));
  if (present(one.ratio)) {
    svg.append(draw("path", { class: "interval model", d: `M${x.at(from)} ${y.at(of(one.ratio, from))}L${x.at(to)} ${y.at(of(one.ratio, to))}` }));
  }
  return svg;
}
function put(id, picture) {
  if (picture) at(id).replaceChildren(picture);
}
function describe(one) {
  const kind = one.to_gravity ? "roll angle relative to gravity" : "roll angle";
  const line = present(one.ratio) ? "Line: the model at the height, with its 95 % interval." : "No height, so no line of the model.";
  return `${clock(one.start_s)} to ${clock(one.end_s)}, channel ${one.channel}. Points: measured ${kind}. ${line}`;
}

// Everything is drawn from what is known, at most once per frame of the screen.
function paint() {
  const { now, start } = known;
  if (start) {
    show("vehicle", start.vehicle);
    document.title = `${start.vehicle}: c.g. height, live`;
    show("source", `${start.source}${now ? `, ${clock(now.time_s)}` : ""}`);
  }
  at("messages").replaceChildren(...(known.messages.length ? known.messages : [{ text: "none" }]).map((one) =>
    make("li", one.bad ? { class: "bad" } : {}, ...(present(one.time) ? [make("time", {}, clock(one.time)), " "] : []), one.text)));
  at("alarm").hidden = !known.level;
  if (known.turn !== known.drawn) {
    put("turn", turn(known.turn));
    show("about", describe(known.turn));
    known.drawn = known.turn;
  }
  put("heights", heights(now));
  if (now) values(now);
}
function values(now) {
  show("height", present(now.height_m) ? fixed(now.height_m, 2, " m") : now.status === "inconsistent" ? "inconsistent" : NONE);
  show("interval", now.height_ci95_m ? `${now.height_ci95_m[0].toFixed(2)} to ${now.height_ci95_m[1].toFixed(2)}` : NONE);
  show("threshold", fixed(now.static_rollover_threshold_g, 2, " g"));
  show("state", now.state);
  show("mass", fixed(now.trailer_mass_kg / 1000, 1, " t"));
  const source = { nominal: "not weighed: any load", kept: "weighed before the restart", signal: "weighed", given: "given" }[now.trailer_mass_source];
  show("scale", `trailer mass, ${source}`);
  show("maneuvers", String(now.maneuvers));
  show("used", `maneuvers used${now.height_restored ? ", none since the start" : ""}`);
  put("gauge", gauge(now));
  const left = fixed(now.margin_g, 2, " g");
  show("margin", present(now.margin_g) ? `${left} left: ${fixed(Math.abs(now.lateral_acceleration_g), 2, " g")} of ${fixed(now.static_rollover_threshold_g, 2, " g")}.`
    : present(now.height_m) ? "no lateral acceleration" : "no height yet, so no threshold");
  show("alarm", known.level ? `Rollover warning, level ${known.level}: ${left} left` : "");
  const chip = (kind, word) => (name) => make("li", { class: kind, title: word }, name.replaceAll("_", " "), make("span", { class: "quiet" }, word === "missing" ? " missing" : ""));
  at("signals").replaceChildren(...now.missing.map(chip("gone", "missing")), ...now.present.map(chip("here", "present")));
  show("foot", `cg ${known.start ? known.start.version : ""}. ${now.samples} samples, ${now.frames} frames, ${now.frames_lost} lost, ${now.values_implausible} implausible values.`);
}
let asked = false;
function paintSoon() {
  if (asked) return;
  asked = true;
  requestAnimationFrame(() => { asked = false; paint(); });
}

// The connection. A phone that left the network gets no message about it, so the time since the last one counts.
const LOST_MS = 6000, AGAIN_MS = 3000;
let heard = Date.now(), source = null;
function link(lost) {
  const ended = known.ended !== null;
  at("link").className = lost ? "lost" : ended ? "" : "live";
  show("link", lost ? (ended ? "ended" : "disconnected") : ended ? "ended" : "live");
  document.body.classList.toggle("lost", lost && !ended);
}
function listen() {
  source = new EventSource("events");
  const on = (name, use) => source.addEventListener(name, (event) => {
    heard = Date.now();
    use(JSON.parse(event.data));
    link(false);
    paintSoon();
  });
  on("history", (lines) => { forget(); lines.forEach(take); });
  on("message", take);
  on("snapshot", present_values);
  on("turn", (one) => { known.turn = one; });
  on("alive", () => {});
  source.onerror = () => {
    link(true);
    // A refused connection is not tried again by the browser.
    if (source.readyState === EventSource.CLOSED) setTimeout(listen, AGAIN_MS);
  };
}
setInterval(() => { if (Date.now() - heard > LOST_MS) link(true); }, 1000);
listen();
