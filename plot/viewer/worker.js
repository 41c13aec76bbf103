// almesh.html: the library in a worker, so that the page answers while it computes. plot/app.py puts almesh.js before
// this, and KINDS (page.face_kind() by corners, degree and parts of an edge) and FIELDS (page.FIELDS).
// Messages: {read: {name, bytes}}, {run: "move" or "improve", motions: {name: text}}, {save: name, hasProof}. Answers:
// {progress}, and in the end {error: sentence}, {saved: [{name, bytes}]}, or {mesh} of read() or run().
const loading = almesh({print() {}, printErr() {}});
let lib, at, mesh = 0, name = "", frames = [], kinds = [];
const typeOf = word => typeof word === "string" ? "string" : "number";
const call = (f, ...words) => lib.ccall(`almesh_${f}`, "number", words.map(typeOf), words) >>> 0;
const text = (f, ...words) => lib.ccall(`almesh_${f}`, "string", words.map(typeOf), words);
const ints = (p, count) => lib.HEAP32.subarray(p >>> 2, (p >>> 2) + count);
const doubles = (p, count) => lib.HEAPF64.slice(p / 8, p / 8 + count);
const fine = (code, ...others) => { if (code && !others.includes(code)) throw Error(text("error")); return code; };
const pointer = k => lib.HEAPU32[(at >>> 2) + k];

function read({name: file, bytes}) {
  name = file.replaceAll("/", "_");
  call("free", mesh), mesh = 0, frames = [];
  lib.FS.writeFile(name, bytes);
  fine(call("read", name, at));
  mesh = pointer(0);
  kinds = faces();
  const boundaries = [];
  for (let k = 0; k < sizes().boundaries; ++k) {
    fine(call("boundary", mesh, k, at, at + 8));
    boundaries.push({name: lib.UTF8ToString(pointer(0)), faces: pointer(2)});
  }
  const forms = [];
  while (call("motion", forms.length, at, at + 4) === 0) forms.push([0, 1].map(k => lib.UTF8ToString(pointer(k))));
  return {boundaries, forms, ...shown("as read", ...stateAfter(call("certify", mesh, 0, 0)))};
}
const stateAfter = code => code ? [text("error"), false] : ["certified: every element is valid, no two overlap", true];

function run(how, motions) {
  for (const [boundary, motion] of Object.entries(motions))  // improve: boundaries without one slide along themselves
    fine(call("set_boundary", mesh, boundary, motion || (how === "move" ? "fixed" : 0)));
  const code = fine(call(how, mesh), 3, 4, 5);
  return shown(how === "move" ? "moved" : "improved", ...stateAfter(code));
}
function progress(user, p) {
  const [iteration, step] = ints(p, 2), [, gradient, , constraint] = doubles(p + 8, 4);
  postMessage({progress: {iteration, step, gradient, constraint}});
  return 0;
}
function save(file, hasProof) {  // a proof comes with the mesh that it is of
  const proof = `${file}.proof`, written = hasProof ? [file, proof, `${proof}.msh`] : [file];
  fine(hasProof ? call("save_proof", mesh, file, proof) : call("save", mesh, file));
  const saved = written.filter(of => lib.FS.analyzePath(of).exists).map(of => ({name: of, bytes: lib.FS.readFile(of)}));
  for (const {name} of saved) lib.FS.unlink(name);
  return {saved};
}

// ------------------------------------------------------------------------------------------- what the viewer is given
function sizes() {
  fine(call("sizes_of", mesh, at));
  const [dim, degree, nodes, elements, boundaries] = ints(at, 5);
  return {dim, degree, nodes, elements, boundaries};
}
function faces() {  // [{... of KINDS, rows}], of each face two elements, or one and -1, and its nodes
  const {degree, elements} = sizes(), tables = {}, rows = {3: [], 4: []}, first = new Map();
  fine(call("elements", mesh, at));
  const [, types, offsets, cells] = Array.from({length: 4}, (_, k) => pointer(k));
  for (let e = 0; e < elements; ++e) {
    const type = lib.HEAP32[(types >>> 2) + e], start = (cells >>> 2) + lib.HEAP32[(offsets >>> 2) + e];
    for (const {corners, vertices, places} of tables[type] ??= tableOf(type, degree)) {
      const key = vertices.map(k => lib.HEAP32[start + k]).sort((a, b) => a - b).join(), other = first.get(key);
      if (other !== undefined) {
        rows[corners][other + 1] = e;
        first.delete(key);
        continue;
      }
      first.set(key, rows[corners].length);
      rows[corners].push(e, -1);
      for (const k of places) rows[corners].push(lib.HEAP32[start + k]);
    }
  }
  const parts = degree === 1 ? 1 : elements < 4000 ? Math.max(degree, 8) : degree;
  return [3, 4].filter(k => rows[k].length).map(k => ({...KINDS[`${k} ${degree} ${parts}`], rows: rows[k]}));
}
function tableOf(type, degree) {
  let p = lib._page_faces(type, degree) >>> 2;
  return Array.from({length: lib.HEAP32[p++]}, () => {
    const corners = lib.HEAP32[p++], count = lib.HEAP32[p++], places = [...lib.HEAP32.subarray(p, p += count)];
    const at = [0, degree, count - 1, count - 1 - degree].slice(0, corners);
    return {corners, places, vertices: at.map(k => places[k])};
  });
}
function shown(label, state, isGood) {  // as page.mesh_data() and page.write_page()
  const {dim, nodes, elements} = sizes(), x = doubles(call("positions", mesh), dim * nodes), values = {}, parts = [];
  for (const field of Object.keys(FIELDS)) {
    const p = call("element_values", mesh, field);
    if (p) values[field] = Float32Array.from(doubles(p, elements));
  }
  const ids = call("element_ids", mesh) / 4;
  values.element_id = Float32Array.from({length: elements}, (_, e) => lib.HEAPU32[ids + 2 * e]);
  frames = [...frames.slice(0, 1), {label, x, values}];
  const ends = [0, 1, 2].map(a => frames.reduce(([low, high], {x}) => {
    for (let k = a; k < x.length && a < dim; k += dim) low = Math.min(low, x[k]), high = Math.max(high, x[k]);
    return [low, high];
  }, a < dim ? [Infinity, -Infinity] : [0, 0]));
  const size = Math.hypot(...ends.map(([low, high]) => high - low)) || 1, centre = ends.map(([a, b]) => (a + b) / 2);
  const step = size / 2 ** 30, rounded = new Int32Array(frames.length * 3 * nodes);
  for (const [f, {x}] of frames.entries())
    for (let k = 0, row = 3 * f * nodes; k < x.length; ++k)
      rounded[row + 3 * Math.floor(k / dim) + k % dim] = Math.round((x[k] - centre[k % dim]) / step);
  let count = 0;
  const add = typed => { parts.push(typed); count += typed.length; return [count - typed.length, typed.length]; };
  const addRows = (rows, columns) => add(Int32Array.from(rows, (v, k) => k < columns ? v : v - rows[k - columns]));
  const data = {dim, centre, step, size, elements, labels: frames.map(frame => frame.label), first: frames.length - 1,
    nodes: addRows(rounded, 3 * nodes), notes: "", state, isGood, curves: {list: []}, rows: [], ...summary(),
    kinds: kinds.map(({rows, ...kind}) => ({...kind, faces: addRows(rows, kind.nodes + 2)})),
    fields: Object.keys(FIELDS).filter(name => values[name]).map(name => ({name, ...FIELDS[name],
      values: frames.map(frame => frame.values[name] ? add(frame.values[name]) : null)}))};
  return {state, isGood, notes: text("notes", mesh), data: JSON.stringify(data), numbers: new Blob(parts)};
}
function summary() {  // a table of the quantities of the run
  const keys = {}, rows = [];
  for (let k = 0; call("quantity", k, at, at + 4) === 0; ++k) {
    const quantity = lib.UTF8ToString(pointer(0));
    keys[quantity] = lib.UTF8ToString(pointer(1));
    const word = text("word", mesh, quantity);
    if (word) rows.push([quantity, word]);
  }
  return {keys, tables: rows.length ? [{name: "summary", columns: ["quantity", "value"], rows, same: []}] : []};
}

onmessage = async ({data: {read: file, run: how, motions, save: path, hasProof}}) => {
  try {
    if (!lib) {
      lib = await loading;
      at = lib._malloc(64);
      lib.FS.mkdir("/page"), lib.FS.chdir("/page");
      lib.progress = lib.addFunction(progress, "iii");
    }
    if (mesh) call("on_progress", mesh, lib.progress, 0);
    postMessage(file ? {mesh: read(file)} : how ? {mesh: run(how, motions)} : save(path, hasProof));
  } catch (error) {
    const isLost = error instanceof WebAssembly.RuntimeError || error instanceof RangeError;
    const told = isLost ? `the library failed, or a page's memory, 4 GB, ended: ${error.message}` : error.message;
    postMessage({error: told, isLost});
  }
};
