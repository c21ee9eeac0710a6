// What the page around this one sends, drawn over the building: {lines} when there are other
// flights, {steps} when the UAVs move, {belief} in place of the map, or {} in it for none.
// LOOK holds height and radius of flights and corners of the map [m], colour and opacity of beliefs.
const flights = new THREE.Group();
const UP = new THREE.Vector3(0, 1, 0);
let uavs = [];

// The plan's axes have z up, the scene's have y up.
const inScene = (x, y, z) => new THREE.Vector3(x, z, -y);

function tubes(points, colour, radius, opacity) {
  const shape = new THREE.CylinderGeometry(radius, radius, 1, 8);
  const look = { color: colour, opacity, transparent: opacity < 1 };
  const n = Math.max(points.length - 1, 0);
  const mesh = new THREE.InstancedMesh(shape, new THREE.MeshBasicMaterial(look), n);
  const place = new THREE.Matrix4(), turn = new THREE.Quaternion();
  for (let k = 0; k < n; k++) {
    const along = points[k + 1].clone().sub(points[k]), length = along.length();
    const middle = points[k].clone().add(points[k + 1]).multiplyScalar(0.5);
    turn.setFromUnitVectors(UP, length > 0 ? along.divideScalar(length) : UP);
    mesh.setMatrixAt(k, place.compose(middle, turn, new THREE.Vector3(1, length + radius, 1)));
  }
  mesh.frustumCulled = false;
  return mesh;
}

function uavAt(points, colour) {
  const shape = new THREE.OctahedronGeometry(5 * LOOK.radius);
  const inFront = { depthTest: false, transparent: true };  // seen through walls, after them
  const body = new THREE.Mesh(shape, new THREE.MeshBasicMaterial({ color: colour, ...inFront }));
  const rim = new THREE.LineBasicMaterial({ color: 0xffffff, ...inFront });
  body.renderOrder = 1;
  const edges = new THREE.LineSegments(new THREE.EdgesGeometry(shape), rim);
  edges.renderOrder = 2;
  body.add(edges);
  const floor = [inScene(0, 0, -LOOK.height), inScene(0, 0, 0)];
  body.add(tubes(floor, colour, LOOK.radius / 2, 1));
  return body;
}

function draw(lines) {
  flights.clear();
  uavs = lines.map(({ x, y, colour }, number) => {
    const height = LOOK.height + 2.5 * number * LOOK.radius;  // so that one sees both
    const points = Array.from(x, (at, k) => inScene(at, y[k], height));
    const flown = tubes(points, colour, LOOK.radius, 1);
    const body = uavAt(points, colour);
    body.visible = points.length > 0;
    flights.add(tubes(points, colour, LOOK.radius / 2, 0.6), flown, body);
    return { points, flown, body };
  });
}

function move(steps) {
  uavs.forEach(({ points, flown, body }, k) => {
    if (!points.length) return;
    const step = Math.min(Math.max(steps[k] ?? 0, 0), points.length - 1);
    flown.count = step;
    body.position.copy(points[step]);
  });
}

let belief = null;
const BELIEF_LIFT = 0.02;

function believe({ cells, columns, darkest }) {
  if (belief) {
    scene.remove(belief);
    belief.material.map.dispose();
  }
  belief = cells ? plane(cells, columns, darkest) : null;
  const [mapBar, bar] = ["colour-bar", "belief-bar"].map((id) => document.getElementById(id));
  mapBar.hidden = Boolean(belief);
  bar.hidden = !belief;
  if (!belief) return;
  bar.querySelectorAll("span")[1].textContent = darkest.toPrecision(2);
  scene.add(belief);
}

function plane(cells, columns, darkest) {
  const pixels = new Uint8Array(4 * cells.length);
  cells.forEach((cell, k) => {
    const opacity = LOOK.opacity * Math.min(cell / darkest, 1);
    pixels.set([...LOOK.belief, Math.round(255 * opacity)], 4 * k);
  });
  const map = new THREE.DataTexture(pixels, columns, cells.length / columns);
  map.needsUpdate = true;
  const [x0, y0, x1, y1] = LOOK.corners;
  const shape = new THREE.PlaneGeometry(x1 - x0, y1 - y0).rotateX(-Math.PI / 2);
  const look = { map, transparent: true, depthWrite: false, side: THREE.DoubleSide };
  const mesh = new THREE.Mesh(shape, new THREE.MeshBasicMaterial(look));
  mesh.position.copy(inScene((x0 + x1) / 2, (y0 + y1) / 2, BELIEF_LIFT));
  mesh.renderOrder = -1;  // before the walls, which are transparent too
  return mesh;
}

// The map may be loaded after the first belief has come.
scene.onBeforeRender = () => {
  const map = scene.getObjectByName("map");
  if (map) map.visible = !belief;
};

window.addEventListener("message", ({ source, data }) => {
  if (source !== parent || !data) return;
  if (data.lines) draw(data.lines);
  if (data.steps) move(data.steps);
  if (data.belief) believe(data.belief);
  if (camera) render();
});
scene.add(flights);
parent.postMessage("flights?", "*");
