// SPDX-License-Identifier: Apache-2.0
// The controls, runs in the worker, and what they give.
const of = id => document.getElementById(id);
const {models, integrators} = JSON.parse(of("about").textContent);
const PAUSE = 350, SNAPSHOTS = 1000, OBJECTS = 16, STEPS = 20000;
const page = {found: null, hidden: new Set(), number: 0};
let worker, module, timer = 0, source;

// ---- the model's text: what it gives, and where it is wrong ----

const declared = (text, pattern) => [...text.matchAll(pattern)].map(found => found.groups);
const paramsOf = text => declared(text, /^[ \t]*(?:param|shared)[ \t]+(?<name>\w+)[ \t]*=[ \t]*(?<value>[^\s#"[]+)/gm);
const lineOf = (text, word) => declared(text, new RegExp(`^[ \\t]*${word}[ \\t]+(?<value>[^\\s#"[]+)`, "gm"))[0]?.value || "";

const showParams = text => {
  const rows = paramsOf(text), old = new Map([...of("params").querySelectorAll("input")].map(input => [input.name, input.value]));
  of("params").replaceChildren(...rows.map(({name, value}) => {
    const label = document.createElement("label"), span = document.createElement("span"), input = document.createElement("input");
    span.textContent = name;
    Object.assign(input, {type: "text", name, placeholder: value, value: old.get(name) || "", autocomplete: "off"});
    input.setAttribute("aria-label", `Parameter ${name}`);
    label.append(span, input);
    return label;
  }));
  of("params").parentElement.hidden = !rows.length;
  of("h").placeholder = lineOf(text, "step");
  of("steps").placeholder = defaultSteps(text);
};

const defaultSteps = text => {
  const steps = Math.round(Number(lineOf(text, "span")) / Number(of("h").value || lineOf(text, "step")));
  return String(Number.isFinite(steps) && steps > 0 ? Math.min(steps, STEPS) : 1000);
};

const showLines = () => {
  const count = of("text").value.split("\n").length;
  of("lines").textContent = Array.from({length: count}, (nothing, i) => i + 1).join("\n");
  scroll();
};

const scroll = () => {
  for (const id of ["marks", "lines"]) of(id).scrollTop = of("text").scrollTop;
  of("marks").scrollLeft = of("text").scrollLeft;
};

// From the column on to the end of the word, or the sign, that is there.
const mark = places => {
  const lines = of("text").value.split("\n");
  of("marks").replaceChildren(...lines.flatMap((line, i) => {
    const here = places.find(place => place.line === i + 1);
    const signs = [...line], at = here ? Math.min(here.column - 1, signs.length) : 0, rest = signs.slice(at).join("");
    if (!here) return [`${line}\n`];
    const marked = document.createElement("mark"), wrong = /^(\w+|.)/u.exec(rest)?.[0] || "";
    marked.textContent = wrong || " ";
    return [signs.slice(0, at).join(""), marked, `${rest.slice(wrong.length)}\n`];
  }), "\n");
  scroll();
};

const goTo = ({line, column}) => {
  const lines = of("text").value.split("\n"), start = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
  const at = start + [...(lines[line - 1] || "")].slice(0, column - 1).join("").length;
  of("text").focus();
  of("text").setSelectionRange(at, at);
};

// "kepler.ode:12:9: error: text"; all else that is said has no place. What stands below such a line shows the source, which is here.
const showMessages = text => {
  const places = [];
  const items = text.split("\n").filter(line => line && !/^\s|^Try `/.test(line)).map(said => {
    const found = /^[^:]*:(\d+):(\d+): (.*)$/.exec(said), item = document.createElement("li");
    if (found && said.startsWith(`${source.file}:`)) {
      const place = {line: Number(found[1]), column: Number(found[2])}, button = document.createElement("button");
      places.push(place);
      button.textContent = `line ${place.line}, column ${place.column}`;
      button.onclick = () => goTo(place);
      item.append(button, found[3]);
    } else item.textContent = said;
    return item;
  });
  of("messages").replaceChildren(...items);
  of("text").setAttribute("aria-invalid", places.length > 0);
  mark(places);
};

// ---- a run ----

const has = (words, ...names) => words.some(word => names.some(name => word === name || word.startsWith(`${name}=`)));

const ask = () => {
  const text = of("text").value, more = of("more").value.split(/\s+/).filter(word => word), name = /^\s*model\s+(\w+)/m.exec(text)?.[1] || "model";
  const steps = of("steps").value.trim() || of("steps").placeholder, h = of("h").value.trim(), file = `${name}.ode`;
  const how = ["--config", of("config").value, ...of("integrator").value ? ["--integrator", of("integrator").value] : [], ...of("arithmetic").value ? [of("arithmetic").value] : []];
  const set = [...of("params").querySelectorAll("input")].filter(input => input.value.trim()).map(input => `${input.name}=${input.value.trim()}`);
  if (h) set.push(`h=${h}`);
  const words = [file, ...how, "--engine", of("engine").value, ...set.flatMap(one => ["--set", one])];
  if (!has(more, "-n", "--steps", "--until", "--tolerance", "--times")) words.push("--steps", steps);
  if (!has(more, "-N", "--objects", "--links")) words.push("--objects", "1");
  if (!has(more, "--every", "--times")) words.push("--every", String(Math.max(1, Math.ceil(Number(steps) / SNAPSHOTS) || 1)));
  source = {file, words: [...words, ...more, "--allow-failures", "--output", "out.csv"]};
  return {number: ++page.number, run: source.words, compile: [file, ...how, "--report"], files: {[file]: new TextEncoder().encode(text)}};
};

const start = () => {
  const url = URL.createObjectURL(new Blob([of("code").textContent], {type: "text/javascript"}));
  worker = new Worker(url);
  URL.revokeObjectURL(url);
  worker.onmessage = ({data}) => show(data);
  worker.onerror = event => tell(`no worker: ${event.message}`);
  worker.postMessage({module});
  worker.isBusy = false;
};

const tell = text => { of("state").textContent = text; };

const go = () => {
  clearTimeout(timer);
  timer = 0;
  if (!module) return;
  if (worker.isBusy) {
    worker.terminate();
    start();
  }
  worker.isBusy = true;
  tell("running");
  of("right").classList.add("stale");
  worker.postMessage(ask());
};

const later = () => {
  clearTimeout(timer);
  timer = setTimeout(go, PAUSE);
};

// ---- what it gives ----

// As tools/everywhere.py has it: all that was recorded, with the lines that tell flags and failures.
const hashOf = async (csv, said) => {
  const lines = said.split("\n").filter(line => /^(flags |.*failed|object \d+ )/.test(line));
  const rest = new TextEncoder().encode(lines.join("\n")), all = new Uint8Array(csv.length + rest.length);
  all.set(csv);
  all.set(rest, csv.length);
  const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", all));
  return [...digest.slice(0, 8)].map(byte => byte.toString(16).padStart(2, "0")).join("");
};

// Columns of numbers, object by object.
const read = csv => {
  const [head, ...lines] = new TextDecoder().decode(csv).trimEnd().split(/\r?\n/), names = head.split(",");
  const at = names.indexOf("object"), time = names.indexOf("time"), shown = names.map((name, i) => i).filter(i => i > at);
  const objects = new Map();
  for (const line of lines) {
    const cells = line.split(","), object = cells[at];
    if (!objects.has(object) && objects.size < OBJECTS) objects.set(object, names.map(() => []));
    objects.get(object)?.forEach((column, i) => column.push(Number(cells[i])));
  }
  return {names, shown, time: time < 0 ? 0 : time, objects: [...objects.values()]};
};

const fill = (select, found, wanted) => {
  const old = [...select.options].map(option => option.textContent).join(), names = found.shown.map(i => found.names[i]);
  if (old === names.join()) return;
  select.replaceChildren(...found.shown.map((i, k) => new Option(names[k], i)));
  select.value = wanted;
};

// The last vector in its plane, or the last state across and the first up.
const choosePlane = found => {
  const named = end => found.shown.filter(i => new RegExp(`_${end}( |$)`).test(found.names[i])).pop(), first = found.shown[0], last = found.shown.at(-1);
  const isPlane = named("x") !== undefined && named("y") !== undefined;
  fill(of("across"), found, isPlane ? named("x") : last);
  fill(of("up"), found, isPlane ? named("y") : first);
};

const draw = () => {
  const {found} = page, palette = colours();
  if (!found) return;
  const lines = found.shown.flatMap((i, k) => page.hidden.has(found.names[i]) ? [] :
    found.objects.map(columns => ({xs: columns[found.time], ys: columns[i], colour: palette[k % palette.length]})));
  plot(of("time"), lines, found.names[found.time], "");
  const [across, up] = [of("across"), of("up")].map(select => Number(select.value));
  plot(of("phase"), found.objects.map((columns, k) => ({xs: columns[across], ys: columns[up], colour: palette[k % palette.length]})), found.names[across], found.names[up]);
};

const showKey = () => {
  const palette = colours(), {found} = page;
  of("key").replaceChildren(...found.shown.map((i, k) => {
    const label = document.createElement("label"), box = document.createElement("input"), patch = document.createElement("i");
    Object.assign(box, {type: "checkbox", checked: !page.hidden.has(found.names[i])});
    patch.style.background = palette[k % palette.length];
    box.onchange = () => {
      page.hidden[box.checked ? "delete" : "add"](found.names[i]);
      draw();
    };
    label.append(box, patch, found.names[i]);
    return label;
  }));
};

const show = async ({number, ran, report}) => {
  worker.isBusy = false;
  if (number !== page.number) return;
  const csv = ran.files["out.csv"];
  showMessages(ran.err);
  of("said").textContent = ran.out;
  of("command").textContent = `fp3 run ${source.words.join(" ")}`;
  of("cycles").textContent = /^cycles per object-step +(\S+)/m.exec(report)?.[1] || "–";
  of("hash").textContent = csv ? await hashOf(csv, ran.out + ran.err) : "–";
  if (csv) {
    page.found = read(csv);
    choosePlane(page.found);
    showKey();
    draw();
  }
  of("right").classList.toggle("stale", !csv);
  tell(!csv ? "not run" : /^failed/m.test(ran.out) ? "objects failed" : "done");
  document.body.dataset.done = number;
};

// ---- the page ----

const choose = () => {
  of("text").value = models[of("model").value];
  of("params").replaceChildren();
  for (const id of ["h", "steps", "more", "integrator", "arithmetic"]) of(id).value = "";
  if (/_stiff$|^robertson$/.test(of("model").value)) of("integrator").value = "rodas3";
  showParams(of("text").value);
  showLines();
  mark([]);
  go();
};

const theme = wanted => {
  document.documentElement.dataset.theme = wanted;
  if (page.found) showKey();
  draw();
};

of("model").replaceChildren(...Object.keys(models).map(name => new Option(name)));
of("integrator").replaceChildren(new Option("default", ""), ...integrators.map(name => new Option(name)));
of("model").value = "kepler" in models ? "kepler" : Object.keys(models)[0];
of("model").onchange = choose;
of("text").oninput = () => {
  showParams(of("text").value);
  showLines();
  mark([]);
  later();
};
of("text").onscroll = scroll;
for (const id of ["integrator", "arithmetic", "engine", "config"]) of(id).onchange = go;
for (const id of ["across", "up"]) of(id).onchange = draw;
for (const id of ["h", "steps", "more", "params"]) of(id).addEventListener("input", later);
of("h").addEventListener("input", () => { of("steps").placeholder = defaultSteps(of("text").value); });
of("theme").onclick = () => theme(document.documentElement.dataset.theme === "dark" ? "light" : "dark");
addEventListener("resize", draw);
theme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");

const unpack = async () => {
  const packed = Uint8Array.from(atob(of("wasm").textContent), sign => sign.charCodeAt(0));
  module = await WebAssembly.compile(await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer());
  start();
  choose();
};
unpack().catch(why => tell(`cannot start: ${why.message}`));
