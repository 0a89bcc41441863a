// A camera that looks at the table from above and aside, in perspective.

const FIELD_OF_VIEW = 0.5; // rad, of the smaller side of the picture
const LOWEST = 0.06, HIGHEST = 1.5;

export class Camera {
  constructor() {
    this.home();
    this.aim = null;
  }

  /** Back to the first direction. */
  home() {
    this.azimuth = -0.95;
    this.elevation = 0.5;
    this.zoom = 1;
  }

  turn(dAzimuth, dElevation) {
    this.azimuth += dAzimuth;
    this.elevation = Math.min(HIGHEST, Math.max(LOWEST, this.elevation + dElevation));
  }

  magnify(factor) {
    this.zoom = Math.min(6, Math.max(0.4, this.zoom * factor));
  }

  /** Aim at a sphere {x, y, z, radius}, by a share of the way there. */
  follow(sphere, share) {
    this.aim ??= { ...sphere };
    for (const key of ["x", "y", "z", "radius"]) this.aim[key] += share * (sphere[key] - this.aim[key]);
  }

  /** Directions and scale for a picture of this size; call before `project`. */
  frame(width, height) {
    const ca = Math.cos(this.azimuth), sa = Math.sin(this.azimuth);
    const ce = Math.cos(this.elevation), se = Math.sin(this.elevation);
    this.back = [ce * ca, ce * sa, se];
    this.right = [-sa, ca, 0];
    this.up = [-se * ca, -se * sa, ce];
    // A flat scene seen from aside is wide: the width decides unless the picture is very wide.
    const smaller = Math.min(width, 1.45 * height);
    this.distance = this.aim.radius / Math.sin(0.5 * FIELD_OF_VIEW) / this.zoom;
    this.scale = (0.5 * smaller) / Math.tan(0.5 * FIELD_OF_VIEW);
    this.middle = [0.5 * width, 0.47 * height];
    this.eye = [
      this.aim.x + this.distance * this.back[0],
      this.aim.y + this.distance * this.back[1],
      this.aim.z + this.distance * this.back[2],
    ];
  }

  /** A point of space -> [x, y, depth] on the picture. */
  project(point) {
    const x = point[0] - this.eye[0], y = point[1] - this.eye[1], z = point[2] - this.eye[2];
    const depth = -(x * this.back[0] + y * this.back[1] + z * this.back[2]);
    const size = this.scale / Math.max(depth, 1e-3);
    return [
      this.middle[0] + size * (x * this.right[0] + y * this.right[1]),
      this.middle[1] - size * (x * this.up[0] + y * this.up[1] + z * this.up[2]),
      depth,
    ];
  }

  /** How many pixels a radius of the disk is long at a point. */
  pixels(point) {
    return this.scale / this.project(point)[2];
  }

  /** Whether a small surface at `point` with outward normal `normal` is seen from its outer side. */
  faces(point, normal) {
    return (
      (this.eye[0] - point[0]) * normal[0] + (this.eye[1] - point[1]) * normal[1] + (this.eye[2] - point[2]) * normal[2] > 0
    );
  }
}
