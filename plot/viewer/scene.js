// The mesh of page.html: its data, what is drawn of it, and the camera. plot/page.py puts this into the page, then
// panels.js, with three.js and what mesh_data() returns.
const $ = id => document.getElementById(id);
const fail = what => { $("picked").textContent = `This page cannot be shown: ${what}`; };
addEventListener("error", event => fail(event.message));
addEventListener("unhandledrejection", event => fail(event.reason));

// --------------------------------------------------------------------------------- what the script put into the page
async function unpacked(id) {
  const given = frameElement?.given?.[id];  // in almesh.html
  if (given) return new Response(given);
  const text = atob($(id).textContent), bytes = new Uint8Array(text.length);
  for (let k = 0; k < bytes.length; ++k) bytes[k] = text.charCodeAt(k);
  $(id).remove();
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")));
}
async function moduleAt(id, from, to) {
  const text = (await (await unpacked(id)).text()).replaceAll(from, to);
  return URL.createObjectURL(new Blob([text], {type: "text/javascript"}));
}
const three = await moduleAt("three", "./three.core.min.js", await moduleAt("three-core", "", ""));
const THREE = await import(three);
const {OrbitControls} = await import(await moduleAt("orbit-controls", "'three'", `'${three}'`));
const data = await (await unpacked("data")).json(), numbers = await (await unpacked("numbers")).arrayBuffer();
function rows([first, count], columns) {  // each row was written less the one before
  const values = new Int32Array(numbers, 4 * first, count);
  for (let k = columns; k < count; ++k) values[k] += values[k - columns];
  return values;
}
const {dim, elements} = data, frames = data.labels.length, nodeCount = data.nodes[1] / frames / 3;
const nodeRows = rows(data.nodes, 3 * nodeCount);
for (const kind of data.kinds) kind.faces = rows(kind.faces, kind.nodes + 2);
for (const field of data.fields)
  field.values = field.values.map(place => place && new Float32Array(numbers, 4 * place[0], place[1]));

function eachFace(callback) {  // with its kind, and its place in kind.faces: two elements, then the nodes
  for (const kind of data.kinds) for (let f = 0; f < kind.faces.length; f += kind.nodes + 2) callback(kind, f);
}

// ----------------------------------------------------------------------------------------------------------- the state
let frame = data.first, field = data.fields[0], low, high, selected = -1, worst = [], isStale = true, isWaiting = false;
const x = new Float32Array(3 * nodeCount);  // from the centre of the mesh, in units of half its diagonal
const centroid = new Float32Array(3 * elements);  // the mean of the middles of an element's faces
const keep = new Uint8Array(elements), unit = data.size / 2;
let normal = null, planeLow = 0, planeHigh = 1;  // of the plane that cuts, towards what is cut away
const coordinate = (e, a) => centroid[3 * e + a] * unit + data.centre[a];
const along = e => normal[0] * centroid[3 * e] + normal[1] * centroid[3 * e + 1] + normal[2] * centroid[3 * e + 2];
function format(v, digits = 4) {
  if (v === undefined) return "";
  return Number.isFinite(v) ? String(+v.toPrecision(digits)) : "inverted";
}

function loadFrame() {
  for (let k = 0; k < x.length; ++k) x[k] = nodeRows[frame * x.length + k] * (data.step / unit);
  centroid.fill(0);
  const count = new Uint8Array(elements);
  const add = (e, mx, my, mz) => {
    ++count[e];
    centroid[3 * e] += mx, centroid[3 * e + 1] += my, centroid[3 * e + 2] += mz;
  };
  eachFace(({faces, nodes, middle}, f) => {
    let mx = 0, my = 0, mz = 0;
    for (let k = 0; k < nodes; ++k) {
      const n = 3 * faces[f + 2 + k];
      mx += middle[k] * x[n], my += middle[k] * x[n + 1], mz += middle[k] * x[n + 2];
    }
    add(faces[f], mx, my, mz);
    if (faces[f + 1] >= 0) add(faces[f + 1], mx, my, mz);
  });
  for (let e = 0; e < elements; ++e) for (let a = 0; a < 3; ++a) centroid[3 * e + a] /= count[e];
}

// The closed parts of the surface; the outermost is the one that goes farthest from the centre.
function surfaceParts() {
  const parent = Int32Array.from({length: nodeCount}, (_, k) => k), reach = new Map();
  const root = k => { while (parent[k] !== k) k = parent[k] = parent[parent[k]]; return k; };
  const outside = callback => eachFace(({faces, nodes}, f) => {
    if (faces[f + 1] < 0) for (let k = f + 2; k < f + 2 + nodes; ++k) callback(faces[k], faces[f + 2]);
  });
  outside((node, first) => { parent[root(node)] = root(first); });
  outside(node => {
    const r = root(node), distance = Math.hypot(x[3 * node], x[3 * node + 1], x[3 * node + 2]);
    reach.set(r, Math.max(reach.get(r) ?? 0, distance));
  });
  const [farthest, next = farthest] = [...reach.values()].sort((a, b) => b - a);
  return {count: reach.size, isOutermost: node => reach.get(root(node)) === farthest, isFar: farthest > 4 * next};
}

// --------------------------------------------------------------------------------------------------------- the scene
THREE.ColorManagement.enabled = false;
const renderer = new THREE.WebGLRenderer({antialias: true}), canvas = renderer.domElement;
renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
renderer.setClearColor(getComputedStyle(document.body).backgroundColor);
renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
$("view").prepend(canvas);
const scene = new THREE.Scene(), camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -20, 40);
const controls = new OrbitControls(camera, canvas), lamp = new THREE.DirectionalLight(0xffffff, 0.35 * Math.PI);
Object.assign(controls, {zoomToCursor: true, enableRotate: dim === 3, zoomSpeed: 1.5});
if (dim === 2) controls.mouseButtons.LEFT = THREE.MOUSE.PAN, controls.touches.ONE = THREE.TOUCH.PAN;
lamp.position.set(0.3, 0.5, 1);
camera.add(lamp);
const Surface = dim === 2 ? THREE.MeshBasicMaterial : THREE.MeshLambertMaterial;
const mesh = new THREE.Mesh(new THREE.BufferGeometry(), new Surface({
  vertexColors: true, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1}));
const lines = style => new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial(style));
const edges = lines({color: 0x1d2733, transparent: true, opacity: 0.45});
// The far walls of an outermost surface that is not drawn, as a background.
const walls = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshLambertMaterial({
  color: 0xe9edf1, side: THREE.BackSide, polygonOffset: true, polygonOffsetFactor: 4, polygonOffsetUnits: 4}));
for (const object of [mesh, edges, walls]) object.frustumCulled = false;
scene.add(camera, new THREE.AmbientLight(0xffffff, 0.7 * Math.PI), mesh, edges, walls);

// The numbers of an attribute with room for `count` rows of three, to be filled anew; the room grows by half.
function room({geometry}, name, count, Type = Float32Array) {
  let attribute = geometry.getAttribute(name);
  if (!attribute || attribute.count < count) {
    geometry.dispose();
    attribute = new THREE.BufferAttribute(new Type(3 * Math.ceil(1.5 * count)), 3, Type === Uint8Array);
    geometry.setAttribute(name, attribute);
  }
  geometry.setDrawRange(0, count);
  attribute.needsUpdate = true;
  return attribute.array;
}

// Colours from good to bad, those of the figures (style.py).
const stops = [0xeef5fb, 0xc3dcee, 0x8fc3d9, 0xf7d57e, 0xf29b4b, 0xd9482b, 0x8c1127]
  .map(c => [c >> 16, c >> 8 & 255, c & 255]);
const ramp = Array.from({length: 256}, (_, i) => {
  const at = i / 255 * (stops.length - 1), k = Math.min(Math.floor(at), stops.length - 2);
  return stops[k].map((c, a) => Math.round(c + (at - k) * (stops[k + 1][a] - c)));
});
function share(v) {  // of the way from low to high
  if (high <= low) return field.worst < 0 ? 1 : 0;
  const s = $("log").checked ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low);
  return Math.min(Math.max(s, 0), 1);
}
function colour(v) {
  if (v === undefined) return [205, 210, 216];
  return ramp[Math.round(255 * (field.worst > 0 ? share(v) : 1 - share(v)))];
}

// The points of a face, sum_a N_a x_a, and its normals there.
function evaluate({nodes, points, basis, faces, triangles}, f, point, normals) {
  for (let q = 0, w = 0; q < 3 * points; q += 3) {
    point[q] = point[q + 1] = point[q + 2] = 0;
    for (let k = f + 2; k < f + 2 + nodes; ++k, ++w)
      for (let a = 0; a < 3; ++a) point[q + a] += basis[w] * x[3 * faces[k] + a];
  }
  if (!normals) return;
  normals.fill(0);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const ux = point[b] - point[a], uy = point[b + 1] - point[a + 1], uz = point[b + 2] - point[a + 2];
    const vx = point[c] - point[a], vy = point[c + 1] - point[a + 1], vz = point[c + 2] - point[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    const length = Math.sqrt(nx * nx + ny * ny + nz * nz) || 1;
    for (const k of [a, b, c]) normals[k] += nx / length, normals[k + 1] += ny / length, normals[k + 2] += nz / length;
  }
}

// Draws the faces between elements that are kept and others, or none.
let owners = new Int32Array(0);  // the element of each triangle drawn
const isDrawn = new Uint8Array(nodeCount);
function rebuild() {
  const isMarked = new Uint8Array(elements), shown = [], behind = [], values = field.values[frame];
  const plane = planeLow + $("place").value * (planeHigh - planeLow), side = $("flip").checked ? -1 : 1;
  for (let e = 0; e < elements; ++e) keep[e] = !normal || side * (along(e) - plane) <= 0;
  if ($("marks").checked) for (const e of worst) isMarked[e] = 1;
  if (selected >= 0) isMarked[selected] |= 2;
  let corners = 0, ends = 0;
  outlined = [];
  eachFace((kind, f) => {
    const a = kind.faces[f], b = kind.faces[f + 1];
    const mark = isMarked[a] | (b < 0 ? 0 : isMarked[b]);
    if (mark) outlined.push([kind, f, mark]);
    if (keep[a] === (b < 0 ? 0 : keep[b])) return;
    const isBehind = b < 0 && parts && !$("outer").checked && parts.isOutermost(kind.faces[f + 2]);
    (isBehind ? behind : shown).push([kind, f]);
    if (!isBehind) corners += kind.triangles.length, ends += kind.outline.length;
  });
  const position = room(mesh, "position", corners), tint = room(mesh, "color", corners, Uint8Array);
  const direction = dim === 3 && room(mesh, "normal", corners);
  const ofEdges = room(edges, "position", ends);
  if (owners.length < corners / 3) owners = new Int32Array(corners / 2);
  const normals = dim === 3 && point.slice();
  const copy = (to, at, from, list) => {
    for (let k = 0; k < list.length; ++k) for (let q = 3 * list[k], a = 0; a < 3; ++a) to[at++] = from[q + a];
    return at;
  };
  let p = 0, l = 0;
  isDrawn.fill(0);
  for (const [kind, f] of shown) {
    for (let k = f + 2; k < f + 2 + kind.nodes; ++k) isDrawn[kind.faces[k]] = 1;
    const element = keep[kind.faces[f]] ? kind.faces[f] : kind.faces[f + 1], rgb = colour(values?.[element]);
    evaluate(kind, f, point, normals);
    if (direction) copy(direction, p, normals, kind.triangles);
    const first = p;
    p = copy(position, p, point, kind.triangles);
    for (let k = first; k < p; ++k) tint[k] = rgb[(k - first) % 3];
    owners.fill(element, first / 9, p / 9);
    l = copy(ofEdges, l, point, kind.outline);
  }
  for (const [{faces, nodes}, f, mark] of outlined)  // the worst elements are to be seen too
    for (let k = f + 2; k < f + 2 + nodes; ++k) isDrawn[faces[k]] |= mark & 1;
  fillOutline(ofWorst, outlined.filter(face => face[2] & 1));
  fillOutline(ofSelected, outlined.filter(face => face[2] & 2));
  fillWalls(behind);
}
function fillWalls(faces) {  // triangles that turn their fronts away from the element
  const corners = faces.reduce((sum, [kind]) => sum + kind.triangles.length, 0);
  const position = room(walls, "position", corners), direction = room(walls, "normal", corners);
  const [a, b, c, n, out] = Array.from({length: 5}, () => new THREE.Vector3());
  let p = 0;
  for (const [kind, f] of faces) {
    evaluate(kind, f, point);
    out.fromArray(centroid, 3 * kind.faces[f]);
    for (let t = 0; t < kind.triangles.length; t += 3, p += 9) {
      [a, b, c].forEach((corner, k) => corner.fromArray(point, 3 * kind.triangles[t + k]));
      n.subVectors(b, a).cross(c.clone().sub(a)).normalize();
      const turned = n.dot(a.clone().sub(out)) < 0, order = turned ? [a, c, b] : [a, b, c];
      if (turned) n.negate();
      order.forEach((corner, k) => { corner.toArray(position, p + 3 * k); n.toArray(direction, p + 3 * k); });
    }
  }
}

// ---------------------------------------------------------------------------------------------- drawing and the camera
const draw = () => { if (!isWaiting) isWaiting = true, requestAnimationFrame(drawNow); };
const update = () => { isStale = true; draw(); };
function drawNow() {
  isWaiting = false;
  if (isStale) isStale = false, rebuild();
  edges.visible = $("edges").checked;
  lift.value = 8 / (halfSize.y * camera.zoom) / (camera.far - camera.near);  // so that a slope does not hide a stroke
  camera.updateMatrixWorld();
  const sides = sidesOnScreen();
  scaleOutlines(sides);
  renderer.render(scene, camera);
  placeBadges(sides);
}
function resize() {
  const {clientWidth: w, clientHeight: h} = $("view");
  if (!w || !h) return;
  renderer.setSize(w, h);
  halfSize.set(w / 2, h / 2);
  Object.assign(camera, {left: -w / h, right: w / h});
  camera.updateProjectionMatrix();
  draw();
}
function look(direction, up) {  // from there, so that all that is drawn is seen, wherever it is in other frames
  if (isStale) isStale = false, rebuild();
  camera.up.set(...up);
  camera.position.set(...direction);
  camera.lookAt(0, 0, 0);
  camera.updateMatrixWorld();
  const box = new THREE.Box3(), point = new THREE.Vector3(), turn = camera.quaternion.clone().invert();
  for (let k = 0; k < frames * nodeCount; ++k)
    if (isDrawn[k % nodeCount])
      box.expandByPoint(point.fromArray(nodeRows, 3 * k).multiplyScalar(data.step / unit).applyQuaternion(turn));
  if (box.isEmpty()) box.set(point.set(-1, -1, -1), new THREE.Vector3(1, 1, 1));
  const size = box.getSize(new THREE.Vector3());
  box.getCenter(controls.target).applyQuaternion(camera.quaternion);
  camera.position.set(...direction).setLength(4).add(controls.target);
  camera.zoom = 1.84 * Math.min(1 / size.y, camera.right / size.x);
  camera.updateProjectionMatrix();
  controls.update();
  draw();
}
const fit = () => dim === 2 ? look([0, 0, 1], [0, 1, 0]) : look([1, -1.6, 0.9], [0, 0, 1]);

let flight = 0;
function fly(e) {  // to where its size, the mean of its longest and shortest edge, fills a third of the height
  const lengths = [];
  eachFace(({faces, corners}, f) => {
    if (faces[f] !== e && faces[f + 1] !== e) return;
    corners.forEach((corner, k) => {
      const p = 3 * faces[f + 2 + corner], q = 3 * faces[f + 2 + corners[(k + 1) % corners.length]];
      lengths.push(Math.hypot(x[p] - x[q], x[p + 1] - x[q + 1], x[p + 2] - x[q + 2]) || 1e-9);
    });
  });
  const size = Math.sqrt(Math.max(...lengths) * Math.min(...lengths));
  const from = controls.target.clone(), to = new THREE.Vector3().fromArray(centroid, 3 * e), start = performance.now();
  const zoom = [camera.zoom, 2 / (3 * size)], offset = camera.position.clone().sub(from);
  cancelAnimationFrame(flight);
  const step = now => {
    const t = Math.min(Math.max((now - start) / 600, 0), 1), s = t * t * (3 - 2 * t);
    controls.target.lerpVectors(from, to, s);
    camera.position.copy(controls.target).add(offset);
    camera.zoom = zoom[0] ** (1 - s) * zoom[1] ** s;
    camera.updateProjectionMatrix();
    controls.update();
    draw();
    if (t < 1) flight = requestAnimationFrame(step);
  };
  flight = requestAnimationFrame(step);
}

// The plane is at a right angle to an axis or the view; what is between it and the viewer is cut away.
function chooseCut(value) {
  const view = camera.position.clone().sub(controls.target).normalize().toArray();
  $("cut").value = value;
  $("flip").checked = false;
  $("place").disabled = value === "";
  normal = value === "" ? null : value === "3" ? view : [0, 1, 2].map(a => a === +value ? Math.sign(view[a]) || 1 : 0);
  planeLow = Infinity, planeHigh = -Infinity;
  for (let e = 0; normal && e < elements; ++e) {
    planeLow = Math.min(planeLow, along(e));
    planeHigh = Math.max(planeHigh, along(e));
  }
  showCut();
}
function showCut() {
  const a = +$("cut").value, plane = planeLow + $("place").value * (planeHigh - planeLow);
  $("at").textContent = !normal || a === 3 ? "" : `${"xyz"[a]} = ${format(plane * normal[a] * unit + data.centre[a])}`;
  update();
}

loadFrame();
const parts = dim === 3 ? surfaceParts() : null;
