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
    if (onRow) body.rows[k].onclick = () => onRow(k);
  });
  return body;
}
function showPicked() {
  const shown = data.fields.filter(f => f.name !== "element_id" && f.values[frame]);
  $("picked").textContent = selected < 0 ? "" : [`element ${idOf(selected)}`,
    ...shown.map(f => `${f.title}: ${format(f.values[frame][selected], 5)}`),
    `centre: ${centre(selected, 5)}`].join("\n");
}
function showLegend() {
  const isLog = $("log").checked, at = s => isLog ? low * (high / low) ** s : low + s * (high - low);
  $("name").textContent = field.title;
  $("meaning").textContent = field.text;
  const colours = Array.from({length: 16}, (_, k) => `rgb(${colour(at(k / 15))})`);
  $("ramp").style.background = `linear-gradient(to top, ${colours})`;
  const step = 10 ** Math.floor(Math.log10((high - low) / 4));
  const nice = [1, 2, 5, 10].map(k => k * step).find(s => (high - low) / s <= 6);
  const ticks = high <= low ? [low] : isLog ? [0, 1, 2, 3, 4].map(k => at(k / 4))
    : Array.from({length: 8}, (_, k) => (Math.ceil(low / nice) + k) * nice).filter(v => v <= high + 1e-9 * nice);
  $("ticks").innerHTML = ticks.map(v => `<span style="bottom: ${100 * share(v)}%">${format(v, 3)}</span>`).join("");
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
  document.querySelectorAll(".frames tbody tr").forEach((row, i) => row.classList.toggle("on", data.rows[i] === k));
  update();
}
function showTable(k) {
  const {name, columns} = data.tables[k], table = document.createElement("table");
  const explained = t => [t, data.keys[t]];
  const rows = data.tables[k].rows.map(row => row.map(t => /^-?\d+\.\d{7,}/.test(t) ? format(+t, 6) : t));
  table.className = name;
  fill(table, columns.map(explained), name === "summary" ? rows.map(([key, value]) => [explained(key), value]) : rows,
    name === "frames" && (i => data.rows[i] >= 0 && showFrame(data.rows[i])));
  $("table").replaceChildren(table);
  [...$("tabs").children].forEach((tab, i) => tab.classList.toggle("on", i === k));
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
  " · wheel: zoom · click: values of an element · keys: F fit · E edges" +
  (dim === 3 ? " · X Y Z look along an axis" : "") + (frames > 1 ? " · space play · ← → frame" : "");
const about = [`${elements} elements, ${nodeCount} nodes`, data.notes, data.state];
$("about").textContent = about.filter(text => text).join(" · ");
addEventListener("keydown", event => {
  if (["number", "range"].includes(event.target.type) || event.target.tagName === "SELECT") return;
  const key = event.key.toLowerCase(), axis = dim === 3 ? "xyz".indexOf(key) : -1;
  if (key === "f") fit();
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
chooseField(0);
resize();
fit();
new ResizeObserver(resize).observe($("view"));
document.body.dataset.ready = "yes";
Object.assign(globalThis, {page: {camera, controls, rebuild, draw: drawNow}});
