// What marks elements in page.html: outlines of the ten worst ones and of the one clicked at, and badges with numbers.
// It follows scene.js.

// Lines some pixels wide: two triangles for each segment, moved apart on the screen.
const STROKE = `
  attribute vec3 start, end;
  uniform vec2 halfSize;
  uniform float halfWidth, lift;
  void main() {
    vec4 a = projectionMatrix * modelViewMatrix * vec4(start, 1.0);
    vec4 b = projectionMatrix * modelViewMatrix * vec4(end, 1.0);
    vec2 along = normalize((b.xy - a.xy) * halfSize + vec2(1e-9, 0.0)), across = vec2(-along.y, along.x);
    gl_Position = mix(a, b, position.x);
    gl_Position.xy += ((2.0 * position.x - 1.0) * along + position.y * across) * halfWidth / halfSize;
    gl_Position.z -= lift;
  }`;
const halfSize = new THREE.Vector2(1, 1), lift = {value: 0};
function stroke(geometry, order, width, colour, opacity, more = {}) {
  const material = new THREE.ShaderMaterial({
    uniforms: {halfSize: {value: halfSize}, lift, halfWidth: {value: width / 2},
      colour: {value: new THREE.Vector4(...new THREE.Color(colour).toArray(), opacity)}},
    vertexShader: STROKE, fragmentShader: "uniform vec4 colour; void main() { gl_FragColor = colour; }",
    transparent: true, depthWrite: false, depthTest: dim === 3, side: THREE.DoubleSide, ...more});
  scene.add(Object.assign(new THREE.Mesh(geometry, material), {frustumCulled: false, renderOrder: order}));
  return material.uniforms.halfWidth;
}
// An outline: what is seen of it on a white border, what the mesh hides of it thin and pale.
function outline(order, width, colour) {
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute([0, -1, 0, 0, 1, 0, 1, -1, 0, 1, 1, 0], 3));
  geometry.setIndex([0, 2, 1, 1, 2, 3]);
  if (dim === 3) stroke(geometry, order, width / 2, colour, 0.4, {depthFunc: THREE.GreaterDepth});
  const border = stroke(geometry, order + 1, width + 3, 0xffffff, 0.9);
  const line = stroke(geometry, order + 2, width, colour, 1);
  return {geometry, scale(s) { line.value = s * width / 2, border.value = s * (width + 3 * s) / 2; }};
}
const ofWorst = outline(1, 2.5, 0x5b21b6), ofSelected = outline(4, 4, 0x111111);

const point = new Float32Array(3 * Math.max(...data.kinds.map(kind => kind.points)));
function fillOutline({geometry}, faces) {  // [[kind, place in kind.faces], ...]
  const ends = [];
  for (const [kind, f] of faces) {
    evaluate(kind, f, point);
    for (const k of kind.outline) ends.push(point[3 * k], point[3 * k + 1], point[3 * k + 2]);
  }
  const both = new THREE.InstancedInterleavedBuffer(new Float32Array(ends.length ? ends : 6), 6);
  geometry.dispose();
  geometry.setAttribute("start", new THREE.InterleavedBufferAttribute(both, 3, 0));
  geometry.setAttribute("end", new THREE.InterleavedBufferAttribute(both, 3, 3));
  geometry.instanceCount = ends.length / 6;
}

// ------------------------------------------------------------------------------------------------------------- badges
const RADIUS = 9, CLEAR = 3;  // pixels: of a badge, and around it
const tags = Array.from({length: 10}, (_, k) =>
  Object.assign(document.createElement("div"), {className: "mark", textContent: (k + 1) % 10 || 10}));
const leaders = document.createElementNS("http://www.w3.org/2000/svg", "svg");
$("view").append(leaders, ...tags);

let outlined = [];  // faces of the worst elements and of the one clicked at
function onScreen(values, k) {  // in pixels of the picture
  const at = new THREE.Vector3().fromArray(values, 3 * k).project(camera);
  return [(at.x + 1) * halfSize.x, (1 - at.y) * halfSize.y];
}
function sidesOnScreen() {  // of the elements that are outlined, between their corners
  const sides = [];
  for (const [{corners, faces}, f] of outlined) {
    const at = corners.map(corner => onScreen(x, faces[f + 2 + corner]));
    at.forEach((p, k) => sides.push([...p, ...at[(k + 1) % at.length]]));
  }
  return sides;
}
// Outlines of small elements are thin, so that one sees the elements.
function scaleOutlines(sides) {
  const mean = sides.reduce((sum, [ax, ay, bx, by]) => sum + Math.hypot(bx - ax, by - ay), 0) / (sides.length || 1);
  ofWorst.scale(Math.min(Math.max(mean / 30, 0.3), 1));
}
function distance(px, py, [ax, ay, bx, by]) {  // of a point from a side
  const ux = bx - ax, uy = by - ay, t = ((px - ax) * ux + (py - ay) * uy) / (ux * ux + uy * uy || 1);
  const s = Math.min(Math.max(t, 0), 1);
  return Math.hypot(px - ax - s * ux, py - ay - s * uy);
}
// Each badge is in its element where that is large enough, else beside what is marked with a line to its middle.
function placeBadges(sides) {
  const [w, h] = [2 * halfSize.x, 2 * halfSize.y], placed = [], drawn = [];
  const anchors = worst.map(e => onScreen(centroid, e));
  const mean = [0, 1].map(a => anchors.reduce((sum, p) => sum + p[a], 0) / (anchors.length || 1));
  tags.forEach((tag, k) => {
    const [ax, ay] = anchors[k] ?? [-1, -1];
    tag.hidden = !$("marks").checked || !(ax >= 0 && ax <= w && ay >= 0 && ay <= h);
    if (tag.hidden) return;
    const clearance = (px, py) => Math.min(...sides.map(side => distance(px, py, side)),
      ...placed.map(([qx, qy]) => Math.hypot(px - qx, py - qy) - RADIUS));
    const away = Math.atan2(ay - mean[1], ax - mean[0]);
    let best = [ax, ay, -1];
    for (const reach of [0, 26, 40, 56, 76, 100, 130]) {
      for (let turn = 0; turn < (reach ? 16 : 1) && best[2] < RADIUS + CLEAR; ++turn) {
        const angle = away + (turn % 2 ? 1 : -1) * Math.ceil(turn / 2) * Math.PI / 8;
        const px = ax + reach * Math.cos(angle), py = ay + reach * Math.sin(angle);
        if (Math.min(px, py, w - px, h - py) < RADIUS + CLEAR) continue;
        const free = clearance(px, py);
        if (free > best[2]) best = [px, py, free];
      }
    }
    const [px, py] = best;
    placed.push([px, py]);
    tag.style.transform = `translate(${px - RADIUS}px, ${py - RADIUS}px)`;
    for (const style of ["#fff; stroke-width: 3", "#5b21b6; stroke-width: 1.2"])
      drawn.push(`<line x1="${px}" y1="${py}" x2="${ax}" y2="${ay}" style="stroke: ${style}" />`);
  });
  leaders.innerHTML = drawn.join("");
}
