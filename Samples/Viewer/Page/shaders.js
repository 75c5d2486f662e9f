// Additions to three's standard material: a grid, belts that run, a least size, ambient occlusion. Each changes the shader once; they
// can be combined.

function extend(material, change) {
  const before = material.onBeforeCompile;
  material.onBeforeCompile = (shader, renderer) => {
    before.call(material, shader, renderer);
    change(shader);
  };
  const keyBefore = material.customProgramCacheKey();
  material.customProgramCacheKey = () => keyBefore + change.toString().length;
  return material;
}

const PLACE_VARYINGS = '#include <common>\nvarying vec3 gridPlace, gridNormal; varying float gridSlopes;';

// Lines every `cell` meters, and stronger ones every ten cells, on what is level, and on slopes of instances whose attribute
// `gridSlope` is 1.
export function addGrid(material, grid) {
  return extend(material, (shader) => {
    Object.assign(shader.uniforms, grid);
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', `${PLACE_VARYINGS} attribute float gridSlope;`)
      .replace('#include <project_vertex>', `#include <project_vertex>
        mat4 gridFrame = modelMatrix;
        #ifdef USE_INSTANCING
          gridFrame = gridFrame * instanceMatrix;
        #endif
        gridPlace = (gridFrame * vec4(transformed, 1.0)).xyz;
        gridSlopes = gridSlope;
        gridNormal = normalize(mat3(gridFrame) * objectNormal);`);
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', `${PLACE_VARYINGS}
        uniform float gridCell, gridStrength;
        float gridLine(vec2 place, float width) {
          vec2 perPixel = fwidth(place);
          vec2 far = abs(fract(place - 0.5) - 0.5) / (perPixel * width);
          // Lines closer than a few pixels would only flicker.
          float fade = 1.0 - smoothstep(0.08, 0.35, max(perPixel.x, perPixel.y));
          return (1.0 - min(min(far.x, far.y), 1.0)) * fade;
        }`)
      .replace('#include <color_fragment>', `#include <color_fragment>
        if (gridNormal.y > (gridSlopes > 0.5 ? 0.6 : 0.99)) {
          vec3 across = normalize(cross(gridNormal, vec3(0.0, 0.0, 1.0)));
          vec2 place = vec2(dot(gridPlace, across), dot(gridPlace, cross(across, gridNormal))) / gridCell;
          float line = max(0.5 * gridLine(place, 1.0), gridLine(place / 10.0, 1.3));
          diffuseColor.rgb *= 1.0 - 0.17 * gridStrength * line;
        }`);
  });
}

// Ribs across belts, which move as their surface does. Needs the grid's place, and the instances' velocity (m/s) and turning:
// x and z of the pivot, rad/s about y.
export function addBelts(material, clock) {
  return extend(material, (shader) => {
    Object.assign(shader.uniforms, clock);
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nattribute vec3 beltVelocity, beltTurning; varying vec3 beltRun, beltTurn;')
      .replace('#include <project_vertex>', '#include <project_vertex>\nbeltRun = beltVelocity; beltTurn = beltTurning;');
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', `#include <common>
        varying vec3 beltRun, beltTurn;
        uniform float seconds;`)
      .replace('#include <color_fragment>', `#include <color_fragment>
        float beltSpeed = length(beltRun);
        if (beltSpeed > 0.0 || beltTurn.z != 0.0) {
          vec2 arm = gridPlace.xz - beltTurn.xy;
          // Ribs every half a meter, or 28 around a bend.
          float ribs = beltSpeed > 0.0 ? 2.0 * (dot(gridPlace, beltRun) / beltSpeed - beltSpeed * seconds)
                                       : 28.0 * (atan(-arm.y, arm.x) - beltTurn.z * seconds) / 6.2831853;
          float edge = fwidth(ribs), rib = abs(fract(ribs) - 0.5);
          diffuseColor.rgb *= 1.0 + 0.9 * smoothstep(0.36 - edge, 0.36 + edge, rib) * (1.0 - smoothstep(0.2, 0.6, edge));
        }`);
  });
}

// Widens each instance, along its own axes, to `leastSize` radians seen from the camera.
export function growSmall(material, least) {
  return extend(material, (shader) => {
    Object.assign(shader.uniforms, least);
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nattribute vec3 halfSize; uniform float leastSize;')
      .replace('#include <begin_vertex>', `#include <begin_vertex>
        #ifdef USE_INSTANCING
          float leastHalf = leastSize * max(0.0, -(modelViewMatrix * instanceMatrix * vec4(0.0, 0.0, 0.0, 1.0)).z);
          // What has no size given keeps its own.
          if (halfSize != vec3(0.0)) transformed *= max(vec3(1.0), vec3(leastHalf) / max(halfSize, vec3(1e-6)));
        #endif`);
  });
}

// Takes from the light of all sides what the surroundings hide, where there is an Occlusion.
export function addOcclusion(material, occlusion) {
  if (!occlusion) return material;
  return extend(material, (shader) => {
    Object.assign(shader.uniforms, occlusion.uniforms);
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', `#include <common>
        uniform sampler2D occlusionMap;
        uniform vec2 occlusionPixel;`)
      .replace('#include <aomap_fragment>', `#include <aomap_fragment>
        float seenSky = texture2D(occlusionMap, gl_FragCoord.xy * occlusionPixel).r;
        reflectedLight.indirectDiffuse *= seenSky;
        reflectedLight.indirectSpecular *= seenSky;`);
  });
}
