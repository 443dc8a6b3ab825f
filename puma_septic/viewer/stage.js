"use strict";
// What stands around the arm: floor, light and shadow, edges, axes, where the camera is, and pictures of it all.
function dressed(viewer, data, pane) {
  const THREE = MeshCat.THREE, scene = viewer.scene;
  const world = (x, y, z) => new THREE.Vector3(x, z, -y);  // the scene lies on its back
  const target = world(...data.target), home = world(...data.eye), distance = home.distanceTo(target);
  const size = Math.max(0.5, distance / 2.95), disc = 1.7 * size;
  let dark = false, following = false, place = null;

  // ---- light, which never adds up to more than white, so that colours keep their hue
  for (const name of ["SpotLight", "PointLightNegativeX", "PointLightPositiveX", "FillLight", "AmbientLight"]) {
    const found = viewer.scene_tree.find(["Lights", name, "<object>"]).object;
    if (found) found.intensity = name === "AmbientLight" ? 0.46 : 0;
  }
  const sky = new THREE.HemisphereLight(0xffffff, 0xb9b9b9, 0.16);
  sky.position.set(0, 0, 1);
  const key = new THREE.DirectionalLight(0xffffff, 0.38);
  const [cx, cy] = data.target;
  key.position.set(cx + 0.6 * size, cy - 0.7 * size, 3.0 * size);
  key.target.position.set(cx, cy, 0.3 * size);
  key.castShadow = true;
  key.shadow.mapSize.set(1024, 1024);
  key.shadow.radius = 5;
  key.shadow.bias = -0.0008;
  key.shadow.normalBias = 0.004 * size;
  Object.assign(key.shadow.camera, {left: -disc, right: disc, top: disc, bottom: -disc, near: 0.1 * size, far: 8 * size});
  scene.add(sky, key, key.target);

  // ---- the floor: a disc with a grid that fades out, drawn as a picture, since thin lines flicker and get lost
  const floor = new THREE.Group(), [bx, by] = data.base;
  const radius = disc + Math.hypot(cx - bx, cy - by);
  const sheet = new THREE.Mesh(new THREE.CircleGeometry(radius, 96));
  const shade = new THREE.Mesh(new THREE.CircleGeometry(radius, 96), new THREE.ShadowMaterial({opacity: 0.2}));
  shade.receiveShadow = true;
  shade.position.z = 0.001 * size;
  floor.add(sheet, shade);
  floor.position.set(bx, by, data.ground - 0.002 * size);
  scene.add(floor);

  function gridTexture() {
    const n = 1536, canvas = document.createElement("canvas"), pen = canvas.getContext("2d");
    canvas.width = canvas.height = n;
    const scale = n / (2 * radius), fine = radius > 3 ? 0.5 : 0.1, strong = 5 * fine;
    const fade = pen.createRadialGradient(n / 2, n / 2, 0, n / 2, n / 2, n / 2);
    const [r, g, b] = dark ? [58, 66, 77] : [226, 231, 236];
    for (const [at, alpha] of [[0, 0.95], [0.6, 0.85], [1, 0]]) fade.addColorStop(at, `rgba(${r},${g},${b},${alpha})`);
    pen.fillStyle = fade;
    pen.fillRect(0, 0, n, n);
    for (const [step, width, alpha] of [[fine, 1, 0.35], [strong, 2.2, 0.7]]) {
      const ink = pen.createRadialGradient(n / 2, n / 2, 0, n / 2, n / 2, n / 2);
      const colour = dark ? "150,163,180" : "120,132,146";
      for (const [at, share] of [[0, 1], [0.55, 0.8], [1, 0]]) ink.addColorStop(at, `rgba(${colour},${alpha * share})`);
      pen.strokeStyle = ink;
      pen.lineWidth = width;
      pen.beginPath();
      for (let k = -Math.floor(radius / step); k * step <= radius; k++) {
        const at = n / 2 + k * step * scale;
        pen.moveTo(at, 0); pen.lineTo(at, n); pen.moveTo(0, at); pen.lineTo(n, at);
      }
      pen.stroke();
    }
    const texture = new THREE.CanvasTexture(canvas);
    texture.anisotropy = viewer.renderer.capabilities.getMaxAnisotropy();
    return [texture, fine];
  }

  function paintFloor() {
    const [texture, fine] = gridTexture();
    if (sheet.material.map) sheet.material.map.dispose();
    sheet.material = new THREE.MeshBasicMaterial({map: texture, transparent: true, depthWrite: false, side: THREE.DoubleSide});
    shade.material.opacity = dark ? 0.45 : 0.2;
    return fine;
  }

  // ---- arms: shadows, and edges where two faces meet at an angle
  const arm = viewer.scene_tree.find(["meshcat", "motion0", "arm"]).object;
  const solids = [];
  viewer.scene_tree.find(["meshcat"]).object.traverse((one) => { one.castShadow = false; });
  arm.traverse((one) => { if (one.isMesh) solids.push(one); });
  const edges = [];
  for (const one of solids) {
    one.castShadow = true;
    one.receiveShadow = true;
    const line = new THREE.LineSegments(
      new THREE.EdgesGeometry(one.geometry, 28), new THREE.LineBasicMaterial({transparent: true, opacity: 0.42}));
    line.raycast = () => {};
    one.add(line);
    edges.push(line);
  }

  // ---- axes at the tool, and those of the world in a corner
  let tool = null;
  arm.traverse((one) => { if (one.name === "tool" && !tool) tool = one; });
  const triad = new THREE.AxesHelper(0.11 * size);
  triad.material.depthTest = false;
  if (tool) tool.add(triad);
  const corner = document.getElementById("corner");
  const arms = ["x", "y", "z"].map((name, k) => {
    const svg = corner.namespaceURI, line = document.createElementNS(svg, "line"), text = document.createElementNS(svg, "text");
    line.setAttribute("class", name);
    text.setAttribute("class", name);
    text.textContent = name;
    corner.append(line, text);
    return {line, text, axis: [[1, 0, 0], [0, 0, -1], [0, 1, 0]][k]};
  });

  function turnCorner() {
    const back = viewer.camera.getWorldQuaternion(new THREE.Quaternion()).invert();
    for (const {line, text, axis} of arms) {
      const at = new THREE.Vector3(...axis).applyQuaternion(back);
      line.setAttribute("x2", 22 * at.x);
      line.setAttribute("y2", -22 * at.y);
      text.setAttribute("x", 29 * at.x);
      text.setAttribute("y", -29 * at.y + 4);
    }
  }

  // ---- the camera
  const eyes = {
    home: home.clone().sub(target).normalize(),
    front: world(1, 0, 0.12).normalize(),
    side: world(0, -1, 0.12).normalize(),
    top: world(0.001, 0, 1).normalize(),
  };

  function look(name) {
    const eye = target.clone().addScaledVector(eyes[name], distance);
    viewer.camera.parent.updateMatrixWorld();
    viewer.camera.position.copy(viewer.camera.parent.worldToLocal(eye));
    viewer.controls.target.copy(viewer.camera.parent.worldToLocal(target.clone()));
    viewer.controls.update();
    place = null;
    viewer.set_dirty();
  }

  const toolPlace = () => viewer.camera.parent.worldToLocal(tool.getWorldPosition(new THREE.Vector3()));

  function follow(on) {
    following = on && tool !== null;
    place = null;
  }

  function step() {
    if (following) {
      scene.updateMatrixWorld(true);
      const now = toolPlace();
      if (place) {
        const moved = now.clone().sub(place);
        viewer.camera.position.add(moved);
        viewer.controls.target.add(moved);
        viewer.set_dirty();
      }
      place = now;
    }
    turnCorner();
  }

  // ---- light or dark
  function paint(isDark) {
    dark = isDark;
    scene.background = null;  // the page's own
    pane.parentElement.classList.toggle("dark", dark);
    for (const line of edges) line.material.color.set(dark ? 0x0b0e12 : 0x1c2128);
    data.motions.forEach((motion, k) => {
      const own = motion.colours[dark ? 1 : 0];
      for (const part of k ? ["path", "arm"] : ["path"]) tint(["meshcat", `motion${k}`, part], own);
      tint(["meshcat", `motion${k}`, "vias"], dark ? "#e8ebef" : "#1a1c21");
    });
    const fine = paintFloor();
    viewer.set_dirty();
    return fine;
  }

  function tint(path, colour) {
    viewer.scene_tree.find(path).object.traverse((one) => { if (one.isMesh) one.material.color.set(colour); });
  }

  // ---- pictures: the scene with its names and its time, on the page's background
  function drawOn(canvas, caption) {
    const source = viewer.renderer.domElement, pen = canvas.getContext("2d");
    const [width, height] = [source.width - source.width % 2, source.height - source.height % 2];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
    const ratio = canvas.width / pane.clientWidth;
    const sky = pen.createLinearGradient(0, 0, 0, canvas.height);
    for (const [at, colour] of dark ? [[0, "#232a33"], [1, "#12161b"]] : [[0, "#fbfcfd"], [1, "#dfe5eb"]]) sky.addColorStop(at, colour);
    pen.fillStyle = sky;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    viewer.render();
    pen.drawImage(source, 0, 0);
    pen.font = `${12 * ratio}px system-ui, sans-serif`;
    const box = pane.getBoundingClientRect();
    for (const label of document.querySelectorAll("#labels span:not([hidden])")) {
      const at = label.getBoundingClientRect();
      const x = (at.left - box.left) * ratio, y = (at.top - box.top) * ratio;
      pen.fillStyle = dark ? "#171b21d0" : "#ffffffd0";
      pen.fillRect(x, y, at.width * ratio, at.height * ratio);
      pen.fillStyle = dark ? "#e8ebef" : "#1c2128";
      pen.fillText(label.textContent, x + 4 * ratio, y + (at.height - 4) * ratio);
    }
    pen.fillStyle = dark ? "#e8ebef" : "#1c2128";
    pen.fillText(caption, 12 * ratio, canvas.height - 12 * ratio);
  }

  return {look, follow, paint, step, drawOn, get dark() { return dark; }, get following() { return following; }};
}
