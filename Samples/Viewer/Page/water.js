// A box of water, for the eye alone: one sees through its surface and its sides.
import { BoxGeometry, Color, Mesh, MeshStandardMaterial } from 'three';

const WATER = new Color('#2f8fb5');

// Adds the box from `lower` to `upper`, meters, to the stage.
export function addWater(stage, [lower, upper]) {
  const size = [0, 1, 2].map((k) => upper[k] - lower[k]);
  const material = new MeshStandardMaterial({ color: WATER, roughness: 0.12, transparent: true, opacity: 0.5, depthWrite: false });
  const water = new Mesh(new BoxGeometry(...size), material);
  water.position.set(...[0, 1, 2].map((k) => (lower[k] + upper[k]) / 2));
  water.renderOrder = 1;
  stage.scene.add(water);
}
