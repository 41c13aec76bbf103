// almesh.html: what is around the viewer. plot/app.py puts it into app.html; worker.js computes.
const $ = id => document.getElementById(id);
const unpacked = async id => {
  const bytes = Uint8Array.from(atob($(id).textContent), c => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).blob();
};
const MOST = 0.8e9;  // bytes of a mesh file, which leave room for a run in the 4 GB of a page
const [three, core, orbit, viewer, code] =
  await Promise.all(["three", "three-core", "orbit-controls", "viewer-page", "worker"].map(unpacked));
const viewerText = await viewer.text(), workerUrl = URL.createObjectURL(code);
let worker, file = null, begun = 0, timer = 0, doing = "", told = "", isBusy = false;
const savedName = () => file.name.replace(/(\.[^.]*)?$/, "-moved$1");

function start() {  // anew after `cancel`, and where the memory did not suffice
  worker?.terminate();
  worker = Object.assign(new Worker(workerUrl), {onmessage: ({data}) => answer(data),
    onerror: ({message}) => answer({error: `this browser cannot compute it: ${message}`, isLost: true})});
}
function say(text, isGood = true) {
  $("state").textContent = text;
  $("state").classList.toggle("failed", !isGood);
}
const showTime = () => {
  $("progress").textContent = `${doing}: ${told}${((performance.now() - begun) / 1000).toFixed(1)} s`;
};
function setBusy(what) {  // "": no longer
  isBusy = what !== "";
  clearInterval(timer);
  if (isBusy) [doing, told, begun, timer] = [what, "", performance.now(), setInterval(showTime, 100)];
  showTime();
  for (const control of $("form").querySelectorAll("button, input")) control.disabled = isBusy;
  $("cancel").hidden = !isBusy;
}
function ask(what, message) {
  setBusy(what);
  worker.postMessage(message);
}
function answer({progress, error, isLost, saved = [], mesh}) {
  if (progress) {
    const {iteration, step, gradient, constraint} = progress;
    told = `iteration ${iteration}, ` + (step ? `Newton step ${step}, |gradient| ${gradient.toExponential(1)}, `
      : `|c_D| ${constraint.toExponential(1)}, `);
    return;
  }
  setBusy("");
  if (error) say(error, false);
  if (error && doing === "reading") {
    $("form").hidden = true;
    $("viewer").replaceWith(Object.assign($("viewer").cloneNode(), {srcdoc: ""}));
  }
  if (isLost && (doing === "moving" || doing === "improving")) again();
  else if (isLost) start();
  for (const {name, bytes} of saved)
    Object.assign(document.createElement("a"), {href: URL.createObjectURL(new Blob([bytes])), download: name}).click();
  if (mesh) show(mesh);
}
function again() {
  start();
  ask("reading again", {read: file});
}
function show({boundaries, forms, state, isGood, notes, data, numbers}) {
  const isAgain = doing === "reading again";  // the fields keep their motions, and the reason stays
  if (!isAgain) say(`${file.name}: ${state}`, isGood);
  $("notes").textContent = notes;
  $("form").hidden = false;
  if (boundaries && !isAgain) {
    $("motions").innerHTML = forms.map(([form, meaning]) => `<dt>${form}<dd>${meaning}`).join("");
    $("boundaries").replaceChildren(...boundaries.map(({name, faces}) => {
      const row = document.createElement("tr"), input = document.createElement("input");
      Object.assign(row.insertCell(), {textContent: name, title: `${faces} faces`});
      row.insertCell().append(Object.assign(input, {name, placeholder: "fixed", ariaLabel: `motion of ${name}`}));
      return row;
    }));
  }
  const frame = Object.assign($("viewer").cloneNode(), {srcdoc: viewerText});
  frame.given = {three, "three-core": core, "orbit-controls": orbit, data, numbers};
  frame.onload = () => takeDropsOn(frame.contentWindow);
  $("viewer").replaceWith(frame);
}
async function take(chosen) {
  if (!chosen || isBusy) return;
  if (chosen.size > MOST)
    return say(`${chosen.name} has ${(chosen.size / 1e9).toFixed(1)} GB: above ${MOST / 1e9} GB a mesh does not fit ` +
               "into the memory of a page, 4 GB; use the program", false);
  say("");
  $("notes").textContent = "";
  setBusy("reading");
  file = {name: chosen.name, bytes: new Uint8Array(await chosen.arrayBuffer())};
  ask("reading", {read: file});
}
function takeDropsOn(target) {
  target.addEventListener("dragover", event => event.preventDefault());
  target.addEventListener("drop", event => { event.preventDefault(); take(event.dataTransfer.files[0]); });
}
const run = how => ask(how === "move" ? "moving" : "improving", {run: how, motions: Object.fromEntries(
  [...$("boundaries").querySelectorAll("input")].map(({name, value}) => [name, value.trim()]))});
$("move").onclick = () => run("move");
$("improve").onclick = () => run("improve");
$("save").onclick = () => ask("saving", {save: savedName()});
$("prove").onclick = () => ask("proving", {save: savedName(), hasProof: true});
$("cancel").onclick = () => {
  const isRead = doing !== "reading";
  setBusy("");
  say(isRead ? `${file.name}: cancelled; this is the mesh as it was read` : "cancelled", false);
  if (isRead) again();
  else start();
};
$("file").onchange = () => take($("file").files[0]);
takeDropsOn(window);
start();
document.body.dataset.ready = "yes";
