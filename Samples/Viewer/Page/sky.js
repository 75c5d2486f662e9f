// The sky that is seen, and the surroundings that bodies reflect and are lit by: the same colors, with a sun and a lamp to mirror.
import { BackSide, Color, Mesh, PMREMGenerator, Scene, ShaderMaterial, SphereGeometry } from 'three';

const REFLECTION_SIZE = 64; // pixels of a side of its cube: the materials are rough, and software prepares four times as many in 10 s

const dome = (material) => {
  const mesh = new Mesh(new SphereGeometry(1, 32, 24), material);
  mesh.frustumCulled = false;
  return mesh;
};

const GRADIENT = `
  uniform vec3 horizon, zenith;
  varying vec3 direction;
  vec3 skyAt(float height) { return mix(horizon, zenith, smoothstep(0.0, 0.75, height)); }`;

// Behind everything.
export function makeSky(colors) {
  const sky = dome(new ShaderMaterial({
    side: BackSide,
    depthWrite: false,
    uniforms: { horizon: colors.horizon, zenith: colors.zenith },
    vertexShader: `
      varying vec3 direction;
      void main() {
        direction = position;
        gl_Position = (projectionMatrix * vec4(mat3(modelViewMatrix) * position, 1.0)).xyww;
      }`,
    fragmentShader: `${GRADIENT}
      void main() {
        gl_FragColor = vec4(skyAt(normalize(direction).y), 1.0);
        #include <colorspace_fragment>
      }`,
  }));
  sky.renderOrder = -1;
  return sky;
}

// As three's materials take it. `colors`: as the sky's, and `ground`; `towardsSun`: a unit vector. The caller disposes of it.
export function makeEnvironment(renderer, colors, towardsSun) {
  const scene = new Scene();
  const surroundings = dome(new ShaderMaterial({
    side: BackSide,
    depthWrite: false,
    uniforms: { horizon: colors.horizon, zenith: colors.zenith, ground: { value: new Color(colors.ground) }, sun: { value: towardsSun } },
    vertexShader: `
      varying vec3 direction;
      void main() {
        direction = position;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: `${GRADIENT}
      uniform vec3 ground, sun;
      void main() {
        vec3 towards = normalize(direction);
        vec3 light = towards.y > 0.0 ? skyAt(towards.y) : mix(horizon, ground, smoothstep(0.0, 0.2, -towards.y));
        light += 5.0 * vec3(1.0, 0.93, 0.82) * pow(max(0.0, dot(towards, sun)), 40.0);
        // A lamp across the sky from the sun, which edges of metal mirror.
        vec2 lamp = vec2(dot(towards, normalize(vec3(-sun.z, 0.0, sun.x))), towards.y - 0.62);
        if (dot(towards.xz, sun.xz) < 0.0) light += 2.0 * (1.0 - smoothstep(0.25, 0.4, abs(lamp.x))) * (1.0 - smoothstep(0.05, 0.12, abs(lamp.y)));
        gl_FragColor = vec4(light, 1.0);
      }`,
  }));
  scene.add(surroundings);
  const generator = new PMREMGenerator(renderer);
  const target = generator.fromScene(scene, 0, 0.1, 10, { size: REFLECTION_SIZE });
  generator.dispose();
  surroundings.geometry.dispose();
  surroundings.material.dispose();
  return target;
}
