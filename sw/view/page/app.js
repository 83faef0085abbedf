// SPDX-License-Identifier: Apache-2.0
// Playing, the controls, the mouse, fingers and keys.
const {about, camera, scene, plots} = fp3;
const of = id => document.getElementById(id);
const canvas = of("scene");
const last = about.snapshots - 1;
let isPlaying = false, isAsked = false, carried = 0, before = 0;

// ---- drawing when there is something new ----

const sizeCanvas = () => {
  const width = Math.max(1, Math.round(canvas.clientWidth * devicePixelRatio)), height = Math.max(1, Math.round(canvas.clientHeight * devicePixelRatio));
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
};

const draw = now => {
  isAsked = false;
  if (isPlaying) advance(now);
  if (!fp3.loaded || !scene.isReady()) return;
  sizeCanvas();
  scene.draw();
  plots.label();
  plots.draw();
  if (!document.body.dataset.first) document.body.dataset.first = Math.round(performance.now());
  document.body.dataset.drawn = scene.snapshot;
  if (isPlaying) fp3.redraw();
};

fp3.redraw = () => {
  if (!isAsked) requestAnimationFrame(draw);
  isAsked = true;
};

// ---- time ----

const timeText = snapshot => {
  const time = fp3.time(snapshot);
  return time === null ? `step ${fp3.step(snapshot)}` : fp3.withUnit(`t = ${fp3.number(time, 6)}`, about.timeUnit);
};

const tell = () => {
  const scrub = of("scrub");
  of("now").textContent = timeText(scene.snapshot);
  scrub.value = scene.snapshot;
  scrub.setAttribute("aria-valuetext", `${timeText(scene.snapshot)}, snapshot ${scene.snapshot + 1} of ${about.snapshots}`);
  const objects = about.objects === 1 ? "1 object" : `${about.objects.toLocaleString("en")} objects`;
  of("facts").textContent = `step ${fp3.step(scene.snapshot)} · snapshot ${scene.snapshot + 1} of ${about.snapshots} · ${objects}`;
};

fp3.go = snapshot => {
  const most = Math.max(0, fp3.loaded - 1);
  scene.snapshot = Math.min(most, Math.max(0, snapshot));
  tell();
  fp3.redraw();
};

// Of the recording in seconds; 0: it has one snapshot, no times, or times in another unit.
const seconds = about.timeUnit === "s" && about.times !== null ? Math.max(0, fp3.time(last) - fp3.time(0)) : 0;

// As many seconds of the recording pass as of the clock. The last snapshot is shown until the next frame.
const snapshotsInReal = passed => {
  const now = scene.snapshot;
  let next = now;
  carried += passed;
  while (next < last && fp3.time(next + 1) - fp3.time(now) <= carried) next++;
  carried = now === last ? 0 : carried - (fp3.time(next) - fp3.time(now));
  return now === last ? 1 : next - now;
};

const snapshotsAt = (rate, passed) => {
  carried += passed * rate;
  const steps = Math.floor(carried);
  carried -= steps;
  return steps;
};

const advance = now => {
  const passed = Math.min(250, now - before) / 1000, speed = of("speed").value;
  const steps = speed === "real" ? snapshotsInReal(passed) : snapshotsAt(Number(speed), passed);
  before = now;
  if (!steps) return;
  const next = scene.snapshot + steps;
  if (next <= last) fp3.go(next); // what is not unpacked yet is waited for
  else if (of("loop").checked && last > 0) fp3.go(next % about.snapshots);
  else {
    fp3.go(last);
    if (scene.snapshot === last) play(false);
  }
};

const play = wanted => {
  if (wanted && scene.snapshot === last) fp3.go(0);
  isPlaying = wanted && last > 0;
  const button = of("play");
  button.textContent = isPlaying ? "\u2016" : "\u25b6";
  button.setAttribute("aria-label", isPlaying ? "Pause" : "Play");
  document.body.dataset.playing = isPlaying;
  before = performance.now();
  carried = 0;
  fp3.redraw();
};

// ---- objects ----

const pick = object => {
  scene.picked = object;
  document.body.dataset.picked = object;
  plots.pick(object);
  if (object >= 0) of("said").textContent = `Object ${object} is picked.`;
  fp3.redraw();
};

const pickNext = by => pick((Math.max(scene.picked, by > 0 ? -1 : 0) + by + about.objects) % about.objects);

// ---- controls ----

const option = (select, text, value, isChosen) => {
  const made = document.createElement("option");
  [made.textContent, made.value, made.selected] = [text, value, isChosen];
  of(select).append(made);
};

const colourBy = number => {
  const field = about.fields[number] || null;
  scene.field = field;
  scene.changed();
  of("colour").value = number;
  of("legend").hidden = !field;
  if (field) {
    of("field").textContent = fp3.named(field.name, field.unit);
    of("least").textContent = fp3.number(field.least, 4);
    of("most").textContent = fp3.number(field.most, 4);
  }
  fp3.redraw();
};

const setUp = () => {
  option("colour", "one colour", -1, false);
  about.fields.forEach((field, i) => option("colour", fp3.named(field.name, field.unit), i, false));
  const usual = Math.min(60, Math.max(5, Math.round(last / 10)));
  const isReal = seconds >= 1 && seconds <= 120;
  if (seconds) option("speed", "real time", "real", isReal);
  for (const rate of [...new Set([1, 2, 5, 10, 15, 30, 60, 120, usual])].sort((a, b) => a - b))
    option("speed", `${rate} / s${seconds ? ` (${fp3.number(rate * seconds / last, 2)}×)` : ""}`, rate, rate === usual && !isReal);
  ["x", "y", "z"].forEach((name, k) => { if (k) option("up", fp3.axes[k] ? fp3.axes[k].name : name, k, k === about.up); });
  of("ramp").style.background = `linear-gradient(to right, ${fp3.stops.map(c => `rgb(${c})`).join()})`;
  of("scrub").max = last;
  of("has-up").hidden = fp3.isFlat;
  of("has-links").hidden = !about.relations.some(relation => relation.links) && !(about.bodies && about.bodies.joints.length);
  of("trails").checked = scene.trails;
  colourBy(about.colour);
};

const toggle = (id, key) => {
  const box = of(id);
  box.addEventListener("change", () => { scene[key] = box.checked; fp3.redraw(); });
};
for (const id of ["links", "trails", "frame"]) toggle(id, id);

const reset = () => { camera.reset(); fp3.redraw(); };
const turnTheme = () => {
  const root = document.documentElement;
  root.dataset.theme = root.dataset.theme === "dark" ? "light" : "dark";
  fp3.redraw();
};
of("play").addEventListener("click", () => play(!isPlaying));
of("scrub").addEventListener("input", event => { play(false); fp3.go(Number(event.target.value)); });
of("colour").addEventListener("change", event => colourBy(Number(event.target.value)));
of("up").addEventListener("change", event => { camera.up = Number(event.target.value); fp3.redraw(); });
of("reset").addEventListener("click", reset);
of("theme").addEventListener("click", turnTheme);
of("help").addEventListener("click", () => of("about-box").showModal());
of("unpick").addEventListener("click", () => { pick(-1); canvas.focus(); });

// ---- the mouse and fingers ----

const fingers = new Map();
let moved = 0;

canvas.addEventListener("pointerdown", event => {
  canvas.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, event);
  if (fingers.size === 1) moved = 0;
});

const pinch = (old, now) => {
  const other = [...fingers.values()].find(finger => finger.pointerId !== now.pointerId);
  const apart = finger => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY);
  camera.zoom(Math.max(1, apart(now)) / Math.max(1, apart(old)));
  camera.pan((now.clientX - old.clientX) / 2 / canvas.clientHeight, (now.clientY - old.clientY) / 2 / canvas.clientHeight);
};

canvas.addEventListener("pointermove", event => {
  const old = fingers.get(event.pointerId);
  if (!old) return;
  const x = event.clientX - old.clientX, y = event.clientY - old.clientY;
  moved += Math.abs(x) + Math.abs(y);
  if (fingers.size === 2) pinch(old, event);
  else if (event.shiftKey || event.buttons === 2) camera.pan(x / canvas.clientHeight, y / canvas.clientHeight);
  else camera.orbit(x / canvas.clientHeight * Math.PI, y / canvas.clientHeight * Math.PI);
  fingers.set(event.pointerId, event);
  fp3.redraw();
});

const release = event => {
  if (event.type === "pointerup" && fingers.size === 1 && moved < 5 && event.button === 0 && camera.view) {
    const box = canvas.getBoundingClientRect();
    pick(scene.at(event.clientX - box.left, event.clientY - box.top));
  }
  fingers.delete(event.pointerId);
};
canvas.addEventListener("pointerup", release);
canvas.addEventListener("pointercancel", release);
canvas.addEventListener("contextmenu", event => event.preventDefault());
canvas.addEventListener("wheel", event => {
  event.preventDefault();
  camera.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)));
  fp3.redraw();
}, {passive: false});

// ---- keys ----

const flip = id => of(id).click();
const keys = {
  " ": () => play(!isPlaying),
  ArrowLeft: event => { play(false); fp3.go(scene.snapshot - (event.shiftKey ? 10 : 1)); },
  ArrowRight: event => { play(false); fp3.go(scene.snapshot + (event.shiftKey ? 10 : 1)); },
  Home: () => fp3.go(0), End: () => fp3.go(last),
  a: () => camera.orbit(0.1, 0), s: () => camera.orbit(-0.1, 0), w: () => camera.orbit(0, 0.1), z: () => camera.orbit(0, -0.1),
  j: () => camera.pan(0.05, 0), k: () => camera.pan(-0.05, 0), i: () => camera.pan(0, 0.05), m: () => camera.pan(0, -0.05),
  "+": () => camera.zoom(1.1), "=": () => camera.zoom(1.1), "-": () => camera.zoom(1 / 1.1),
  n: () => pickNext(1), p: () => pickNext(-1), Escape: () => pick(-1),
  c: () => colourBy((Number(of("colour").value) + 2) % (about.fields.length + 1) - 1),
  l: () => flip("links"), t: () => flip("trails"), x: () => flip("frame"),
  r: reset, d: turnTheme, "?": () => of("about-box").showModal(),
};

// A control has keys of its own: a list all, the bar of time those that move it, and the others the one that presses them.
const isTaken = event => {
  const own = event.target.closest("select, input, button");
  if (!own) return false;
  return own.tagName === "SELECT" || (own.type === "range" ? /^(Arrow|Home|End|Page)/.test(event.key) : event.key === " ");
};

document.addEventListener("keydown", event => {
  const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (!act || event.ctrlKey || event.metaKey || event.altKey || of("about-box").open || isTaken(event)) return;
  event.preventDefault();
  act(event);
  fp3.redraw();
});

// ---- what the file says ----

const describe = () => {
  const {facts} = about;
  document.title = about.title;
  of("title").textContent = about.title;
  of("doc").textContent = facts.doc;
  const rows = [["recording", facts.file], ["model", facts.model], ["integrator", facts.integrator], ["engine", facts.engine],
    ["configuration", facts.configuration], ["position", `${about.position.name}: ${fp3.axes.map(column => fp3.named(column.name, column.unit)).join(", ")}`]];
  if (!about.position.hasOneScale) rows.push(["axes", "each has a scale of its own, since their units differ"]);
  if (about.radius > 0) rows.push(["radius", fp3.withUnit(fp3.number(about.radius), fp3.axes[0].unit)]);
  for (const column of about.columns)
    rows.push([column.name, column.bound > 0 ? `kept to ${fp3.withUnit(`± ${fp3.number(column.bound, 3)}`, column.unit)}` : "kept exactly"]);
  for (const [name, value] of rows) {
    if (!value) continue;
    const [term, meaning] = [document.createElement("dt"), document.createElement("dd")];
    [term.textContent, meaning.textContent] = [name, value];
    of("holds").append(term, meaning);
  }
};

// Each pair joins two objects; relations are drawn together.
const readLinks = async () => {
  const lists = [];
  for (const [i, relation] of about.relations.entries()) if (relation.links) lists.push(await fp3.pairs(i, relation.links));
  if (!lists.length) return;
  const pairs = new Uint32Array(lists.reduce((sum, list) => sum + list.length, 0));
  let at = 0;
  for (const list of lists) { pairs.set(list, at); at += list.length; }
  scene.setPairs(pairs);
  fp3.redraw();
};

document.documentElement.dataset.theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
describe();
setUp();
tell();
fp3.listeners.push(() => { document.body.dataset.loaded = fp3.loaded; fp3.redraw(); });
new ResizeObserver(() => fp3.redraw()).observe(of("view"));
document.addEventListener("DOMContentLoaded", () => readLinks().catch(fp3.fail));
