// Contacts between the frames that have them: each point goes with its two bodies. Where these no longer agree on it, having slid,
// rolled or parted, it is hidden: nobody knows where they touch then.
import { Quaternion, Vector3 } from 'three';

const AGREEMENT = 0.05; // of a typical body's radius: as far as a point may be from the other body's

// Reads poses of samples and of the timeline without a new object for each.
class Mover {
  constructor(timeline) {
    this.timeline = timeline;
    this.place = new Vector3();
    this.turn = new Quaternion();
  }
  // Moves a point with a body from one of its samples to where it is now; turns a direction with it.
  move(body, sample, point, direction) {
    const { samples } = this.timeline.recording, { positions, rotations } = this.timeline;
    this.turn.fromArray(samples.rotations, 4 * sample).normalize().conjugate();
    point.sub(this.place.fromArray(samples.positions, 3 * sample)).applyQuaternion(this.turn);
    direction.applyQuaternion(this.turn);
    this.turn.fromArray(rotations, 4 * body).normalize();
    point.applyQuaternion(this.turn).add(this.place.fromArray(positions, 3 * body));
    direction.applyQuaternion(this.turn);
  }
}

// `contacts`: of the last frame that has them, as Timeline.contacts returns them; those of their own frame are returned as they are.
export function contactsNow(contacts, timeline, typical) {
  if (!contacts || timeline.frame === contacts.frame) return contacts;
  const { bodies, points, normals } = contacts;
  const moved = {
    frame: timeline.frame, count: 0, points: new Float32Array(points.length), normals: new Float32Array(normals.length),
    separations: new Float32Array(contacts.count), impulses: new Float32Array(contacts.count),
  };
  const mover = new Mover(timeline), ends = [new Vector3(), new Vector3()], normal = new Vector3();
  for (let i = 0; i < contacts.count; ++i) {
    const pair = [bodies[2 * i], bodies[2 * i + 1]];
    if (!pair.every((body) => timeline.isThere(body))) continue;
    pair.forEach((body, k) => {
      ends[k].fromArray(points, 3 * i);
      mover.move(body, timeline.sampleAt(body, contacts.frame), ends[k], normal.fromArray(normals, 3 * i));
    });
    if (!(ends[0].distanceTo(ends[1]) <= AGREEMENT * typical)) continue;
    const at = moved.count++;
    ends[0].add(ends[1]).multiplyScalar(0.5).toArray(moved.points, 3 * at);
    normal.toArray(moved.normals, 3 * at);
    moved.separations[at] = contacts.separations[i];
    moved.impulses[at] = contacts.impulses[i];
  }
  return moved;
}
