// The panels of page.html: legend, worst elements, tables, and what mouse and keys do. It follows scene.js.
const idOf = e => data.fields.find(f => f.name === "element_id")?.values[frame]?.[e] ?? e + 1;
const centre = (e, digits) => `(${[0, 1, 2].slice(0, dim).map(a => format(coordinate(e, a), digits)).join(", ")})`;
function elementAt(point) {  // that one sees at this point of the picture, in -1 .. 1 across and up; or -1
  const ray = new THREE.Raycaster();
  ray.setFromCamera(point, camera);
  mesh.geometry.computeBoundingSphere();
  const [hit] = ray.intersectObject(mesh);
  return hit ? owners[hit.faceIndex] : -1;
}
function select(e, isTarget) {  // a target that something hides is uncovered
  selected = e;
  showPicked();
  showWorst();
  if (isTarget && dim === 3 && elementAt(new THREE.Vector3().fromArray(centroid, 3 * e).project(camera)) !== e) {
    chooseCut("3");
    $("place").value = Math.min((along(e) - planeLow) / (planeHigh - planeLow) + 1e-5, 1);
    showCut();
  }
  if (isTarget) fly(e);
  update();
}

function fill(table, columns, rows, onRow) {  // cells are texts, or [text, explanation]
  const append = (row, tag, cells) => cells.forEach(cell => {
    const [text, title] = [cell].flat(), made = row.appendChild(document.createElement(tag));
    made.textContent = text;
    if (title) made.title = title;
  });
  table.replaceChildren();
  append(table.createTHead().insertRow(), "th", columns);
  const body = table.createTBody();
  rows.forEach((cells, k) => {
    append(body.insertRow(), "td", cells);
    if (!onRow) return;
    Object.assign(body.rows[k], {tabIndex: 0, onclick: () => onRow(k)});
    body.rows[k].onkeydown = event => { if (event.key === "Enter") onRow(k); };
  });
  return body;
}
function showPicked() {
  const shown = data.fields.filter(f => f.name !== "element_id" && f.values[frame]);
  $("picked").textContent = selected < 0 ? "" : [`element ${idOf(selected)}`,
    ...shown.map(f => `${f.title}: ${format(f.values[frame][selected], 5)}`),
    `centre: ${centre(selected, 5)}`].join(" · ");
}
function showLegend() {
  const isLog = $("log").checked, at = s => isLog ? low * (high / low) ** s : low + s * (high - low);
  $("meaning").textContent = field.text;
  const colours = Array.from({length: 16}, (_, k) => `rgb(${colour(at(k / 15))})`);
  $("ramp").style.background = `linear-gradient(to right, ${colours})`;
  const step = 10 ** Math.floor(Math.log10((high - low) / 4));
  const nice = [1, 2, 5, 10].map(k => k * step).find(s => (high - low) / s <= 6);
  const ticks = high <= low ? [low] : isLog ? [0, 1, 2, 3, 4].map(k => at(k / 4))
    : Array.from({length: 8}, (_, k) => (Math.ceil(low / nice) + k) * nice).filter(v => v <= high + 1e-9 * nice);
  $("ticks").innerHTML = ticks.map(v => `<span style="left: ${100 * share(v)}%">${format(v, 3)}</span>`).join("");
}
function chooseField(k) {  // with one range for all frames, so that colours can be compared
  field = data.fields[k];
  low = Infinity, high = -Infinity;
  for (const values of new Set(field.values))
    for (const v of values ?? []) if (Number.isFinite(v)) low = Math.min(low, v), high = Math.max(high, v);
  $("log").checked = low > 0 && high > 20 * low && field.name !== "element_id";
  $("from").value = format(low), $("to").value = format(high);
  showLegend();
  showFrame(frame);
}
function showWorst() {
  const v = field.values[frame], isWorse = (a, b) => field.worst * (v[a] - v[b]) > 0;
  worst = [];
  for (let e = 0; v && e < elements; ++e) {
    if (worst.length === 10 && !isWorse(e, worst[9])) continue;
    const place = worst.findIndex(other => isWorse(e, other));
    worst.splice(place < 0 ? worst.length : place, 0, e);
    worst.length = Math.min(worst.length, 10);
  }
  const body = fill($("worst"), ["", "id", field.title, "centre"],
    worst.map((e, k) => [k + 1, idOf(e), format(v[e], 5), centre(e, 3)]), k => select(worst[k], true));
  worst.forEach((e, k) => body.rows[k].classList.toggle("on", e === selected));
}
function showFrame(k) {
  frame = k;
  loadFrame();
  showWorst();
  showPicked();
  $("frame").value = k;
  $("label").textContent = `${data.labels[k]} (${k + 1} of ${frames})` +
    (worst.length ? `: worst ${field.title} ${format(field.values[k][worst[0]])}` : "");
  showRow();
  for (const {now} of charts) now();
  update();
}
let shownTable = -1;
function showTable(k) {
  const {name, columns, rows, same} = data.tables[k], table = document.createElement("table");
  const isFrames = name === "frames";
  const broken = t => t.replaceAll("_", "_\u200b");  // a line may end there
  const explained = t => [broken(t), data.keys[t]];
  const heading = t => isFrames && data.frameColumns[t] ? [data.frameColumns[t][0], `${t}: ${data.frameColumns[t][1]}`]
    : explained(t);
  shownTable = k;
  const shown = t => isFrames && t === "converged" ? "✓"
    : /^-?\d+\.\d{4,}(e.\d+)?$/.test(t) ? format(+t, isFrames ? 3 : 6) : t;
  table.className = name;
  fill(table, columns.map(heading),
    rows.map(row => name === "summary" ? [explained(row[0]), row[1]] : row.map(t => broken(shown(t)))),
    isFrames && (i => {
      play(false);
      if (data.rows[i] >= 0) showFrame(data.rows[i]);
      showRow(i);
    }));
  [...table.rows].forEach(row => columns.forEach((column, i) => {
    row.cells[i].classList.add(["status", "path"].includes(column) ? "words" : column);
    row.cells[i].hidden = isFrames && data.frameColumns[column]?.[0] === "";
  }));
  if (isFrames) [...table.tBodies[0].rows].forEach((row, i) => row.classList.toggle("missing", data.rows[i] < 0));
  const notes = [same.length && `in all rows: ${same.map(([column, value]) => `${column} ${shown(value)}`).join(", ")}`,
    !Object.keys(data.keys).length && name !== "frames" && "What these names mean is not in this page: plot/page.py " +
    "found no program almesh that could tell; `almesh --keys` does."];
  $("notes").textContent = notes.filter(text => text).join(". ");
  $("row").textContent = "";
  $("table").replaceChildren(table);
  [...$("tabs").children].forEach((tab, i) => tab.classList.toggle("on", i === k));
  showRow();
}
function showRow(chosen = data.rows.indexOf(frame)) {  // of the table of frames, and all that it says
  document.querySelectorAll(".frames tbody tr").forEach((row, i) => {
    if (i === chosen && !row.classList.contains("on")) row.scrollIntoView({block: "nearest"});
    row.classList.toggle("on", i === chosen);
  });
  const {name, columns, rows} = data.tables[shownTable] ?? {};
  if (name === "frames" && chosen >= 0)
    $("row").textContent = rows[chosen].map((t, k) => t && `${columns[k]} ${/\.\d{5,}/.test(t) ? format(+t, 6) : t}`)
      .filter(t => t).join(", ");
}
let playing = 0;
function play(isOn) {
  clearInterval(playing);
  const pause = Math.max(80, Math.min(600, 6000 / frames));
  playing = isOn ? setInterval(() => showFrame((frame + 1) % frames), pause) : 0;
  $("play").textContent = isOn ? "❚❚ pause" : "▶ play";
}

// ---------------------------------------------------------------------------------------------------------- the wiring
$("field").append(...data.fields.map((f, k) => new Option(f.title, k)));
$("field").onchange = $("reset").onclick = () => chooseField(+$("field").value);
$("from").onchange = $("to").onchange = $("log").onchange = () => {
  low = +$("from").value, high = +$("to").value;
  $("log").checked &&= low > 0;
  showLegend();
  update();
};
$("edges").onchange = draw;
$("marks").onchange = update;
$("outer").onchange = () => { update(); fit(); };
$("cut").onchange = () => chooseCut($("cut").value);
$("place").oninput = $("flip").onchange = showCut;
$("frame").max = frames - 1;
$("frame").oninput = () => { play(false); showFrame(+$("frame").value); };
$("play").onclick = () => play(!playing);
$("tabs").append(...data.tables.map(({name}, k) =>
  Object.assign(document.createElement("button"), {textContent: name, onclick: () => showTable(k)})));
$("help").textContent = (dim === 3 ? "drag: turn · right drag: move" : "drag: move") +
  " · wheel: zoom · click: values · keys: F fit · E edges · 1 … 0 worst elements" +
  (dim === 3 ? " · X Y Z axes" : "") + (frames > 1 ? " · space play · ← → frame" : "");
const about = [data.state, `${elements} elements, ${nodeCount} nodes`, data.notes];
$("about").classList.toggle("failed", !data.isGood);
$("about").textContent = $("about").title = about.filter(text => text).join(" · ");
addEventListener("keydown", event => {
  const {tagName, type} = event.target;
  if (event.ctrlKey || event.altKey || event.metaKey || tagName === "SELECT" || type === "number") return;
  const isOfControl = event.key.startsWith("Arrow") ? type === "range"
    : event.key === " " && (tagName === "BUTTON" || type === "checkbox");
  if (isOfControl) return;
  const key = event.key.toLowerCase(), axis = dim === 3 ? "xyz".indexOf(key) : -1;
  if (key === "f") fit();
  else if (/^[0-9]$/.test(key) && worst[(+key + 9) % 10] >= 0) select(worst[(+key + 9) % 10], true);
  else if (key === "escape") select(-1, false);
  else if (key === "e") $("edges").click();
  else if (axis >= 0) look([[1, 0, 0], [0, -1, 0], [0, 0, 1]][axis], axis === 2 ? [0, 1, 0] : [0, 0, 1]);
  else if (key === " " && frames > 1) event.preventDefault(), play(!playing);
  else if (key === "arrowright" || key === "arrowleft")
    play(false), showFrame((frame + (key === "arrowright" ? 1 : frames - 1)) % frames);
});
let pressed = [0, 0];
canvas.addEventListener("pointerdown", event => {
  pressed = [event.clientX, event.clientY];
  cancelAnimationFrame(flight);
});
canvas.addEventListener("click", event => {
  if (Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return;
  const box = canvas.getBoundingClientRect();
  const across = (event.clientX - box.left) / box.width, down = (event.clientY - box.top) / box.height;
  select(elementAt(new THREE.Vector2(2 * across - 1, 1 - 2 * down)), false);
});
controls.addEventListener("change", draw);

$("outer-label").hidden = !parts || parts.count < 2;
$("outer").checked = !parts?.isFar;
$("space").hidden = dim === 2;
document.querySelector("footer").hidden = frames < 2;
if (data.tables.length) showTable(0);
resize();
for (const {draw} of charts) draw();
chooseField(0);
fit();
new ResizeObserver(resize).observe($("view"));
new ResizeObserver(() => charts.forEach(({draw}) => draw())).observe($("curves"));
document.body.dataset.ready = "yes";
Object.assign(globalThis, {page: {camera, controls, rebuild, draw: drawNow, sides: sidesOnScreen}});
