// The place that bodies are shown in: renderer, camera, light, sky and grid.
import {
  BackSide, Color, DirectionalLight, Fog, HemisphereLight, Mesh, MeshStandardMaterial, NeutralToneMapping,
  PCFShadowMap, PerspectiveCamera, PlaneGeometry, Scene, ShaderMaterial, SphereGeometry, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const HORIZON = new Color('#dde4ea');
const ZENITH = new Color('#f7f9fb');
const LIGHT_DIRECTION = new Vector3(-0.55, 1, 0.62).normalize();

function makeSky() {
  const material = new ShaderMaterial({
    side: BackSide,
    depthWrite: false,
    uniforms: { horizon: { value: HORIZON }, zenith: { value: ZENITH } },
    vertexShader: `
      varying vec3 direction;
      void main() {
        direction = position;
        gl_Position = (projectionMatrix * vec4(mat3(modelViewMatrix) * position, 1.0)).xyww;
      }`,
    fragmentShader: `
      uniform vec3 horizon, zenith;
      varying vec3 direction;
      void main() {
        gl_FragColor = vec4(mix(horizon, zenith, smoothstep(0.0, 0.6, normalize(direction).y)), 1.0);
        #include <colorspace_fragment>
      }`,
  });
  const sky = new Mesh(new SphereGeometry(1, 24, 16), material);
  sky.frustumCulled = false;
  sky.renderOrder = -1;
  return sky;
}

// Adds lines every `cell` meters, and stronger ones every ten cells, to what faces upwards.
export function addGrid(material, grid) {
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, grid);
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nvarying vec3 gridPlace; varying float gridUp;')
      .replace('#include <project_vertex>', `#include <project_vertex>
        mat4 gridFrame = modelMatrix;
        #ifdef USE_INSTANCING
          gridFrame = gridFrame * instanceMatrix;
        #endif
        gridPlace = (gridFrame * vec4(transformed, 1.0)).xyz;
        gridUp = normalize(mat3(gridFrame) * objectNormal).y;`);
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', `#include <common>
        varying vec3 gridPlace; varying float gridUp;
        uniform float gridCell, gridStrength;
        float gridLine(vec2 place, float width) {
          vec2 perPixel = fwidth(place);
          vec2 far = abs(fract(place - 0.5) - 0.5) / (perPixel * width);
          // Lines closer than a few pixels would only flicker.
          float fade = 1.0 - smoothstep(0.08, 0.35, max(perPixel.x, perPixel.y));
          return (1.0 - min(min(far.x, far.y), 1.0)) * fade;
        }`)
      .replace('#include <color_fragment>', `#include <color_fragment>
        if (gridUp > 0.99) {
          vec2 place = gridPlace.xz / gridCell;
          float line = max(0.5 * gridLine(place, 1.0), gridLine(place / 10.0, 1.3));
          diffuseColor.rgb *= 1.0 - 0.3 * gridStrength * line;
        }`);
  };
  return material;
}

export class Stage {
  // `subject`: { center: [x, y, z], radius, lowest } in meters, what the picture is about.
  constructor(canvas, subject) {
    this.subject = subject;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.toneMapping = NeutralToneMapping;
    this.scene = new Scene();
    this.scene.fog = new Fog(HORIZON, 1, 1000);
    this.scene.add(makeSky());
    this.#addLights();
    this.camera = new PerspectiveCamera(36, 1, 0.1, 1000);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    const cell = 10 ** Math.max(-1, Math.round(Math.log10(subject.radius / 18)));
    this.grid = { gridCell: { value: cell }, gridStrength: { value: 1 } };
  }

  // A floor for a scene that has none: it only shows the grid and the shadows.
  addGround() {
    const { center, radius, lowest } = this.subject;
    const material = addGrid(new MeshStandardMaterial({ color: '#cfd6dc', roughness: 1 }), this.grid);
    const ground = new Mesh(new PlaneGeometry(80 * radius, 80 * radius).rotateX(-Math.PI / 2), material);
    ground.position.set(center[0], lowest - 0.02 * radius, center[2]);
    ground.receiveShadow = true;
    this.scene.add(ground);
  }

  // From the front, the right and a little above, so that the subject fills the picture.
  frameSubject() {
    const { center, radius } = this.subject;
    const half = (this.camera.fov * Math.PI) / 360;
    const narrowest = Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect));
    const distance = radius / Math.sin(narrowest);
    // The controls take some of the lower edge.
    this.controls.target.set(center[0], center[1] - 0.1 * radius, center[2]);
    this.camera.position.set(0.62, 0.42, 1).normalize().multiplyScalar(distance).add(this.controls.target);
    this.controls.update();
  }

  resize() {
    const { clientWidth, clientHeight } = this.renderer.domElement.parentElement;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / Math.max(1, clientHeight);
    this.camera.updateProjectionMatrix();
  }

  render() {
    const { radius } = this.subject;
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = Math.max(distance, 0.2 * radius) / 200;
    this.camera.far = distance + 60 * radius;
    this.camera.updateProjectionMatrix();
    this.scene.fog.near = distance + 1.5 * radius;
    this.scene.fog.far = distance + 14 * radius;
    this.renderer.render(this.scene, this.camera);
  }

  #addLights() {
    const { center, radius } = this.subject;
    this.scene.add(new HemisphereLight('#ffffff', '#cfc8be', 2.1));
    const sun = new DirectionalLight('#fff4e2', 2.2);
    sun.target.position.set(...center);
    sun.position.copy(LIGHT_DIRECTION).multiplyScalar(4 * radius).add(sun.target.position);
    sun.castShadow = true;
    sun.shadow.mapSize.set(2048, 2048);
    const reach = 1.35 * radius;
    Object.assign(sun.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: radius, far: 8 * radius });
    sun.shadow.normalBias = (2.5 * reach) / 2048;
    sun.shadow.bias = -0.0002;
    sun.shadow.radius = 3;
    this.scene.add(sun, sun.target);
    // From the other side, so that nothing seen from the front is flat gray.
    const fill = new DirectionalLight('#dbe8ff', 0.6);
    fill.position.set(0.9, 0.3, 0.2);
    this.scene.add(fill);
  }
}
