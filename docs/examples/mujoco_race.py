"""The same passage in MuJoCo, an engine for robots: `pip install mujoco`, then run this file."""

import mujoco
import numpy as np

import explorer as ex

WORLD = """
<mujoco>
  <option timestep="{step}" gravity="0 0 -1" integrator="implicitfast" cone="elliptic" impratio="100"
          iterations="200" tolerance="1e-14"/>
  <default><geom friction="10 0 0" condim="3" solref="{softness} 1" solimp="0.999 0.9999 0.0001 0.5 2"/></default>
  <worldbody>
    <geom type="plane" size="50 50 1"/>
    <body pos="0 0 1">
      <freejoint/>
      <inertial pos="0 0 0" mass="1" diaginertia="0.25 0.25 0.5"/>
      <geom type="cylinder" size="1 0.0005"/>
    </body>
  </worldbody>
</mujoco>
"""


def follow(state, step, t_end):
    """Times, tilt and turned angle of the contact point, in MuJoCo, from a state with m = r = g = 1."""
    phi, phidot, sigma3, sigma4 = (
        np.ravel(each).item() for each in (state.phi, state.phidot, state.sigma3, state.sigma4)
    )
    c, s = np.cos(phi), np.sin(phi)
    heading, axis, up = np.array([1.0, 0, 0]), np.array([0, c, s]), np.array([0, -s, c])
    turning = phidot * heading + sigma4 * axis + sigma3 / c * up
    attitude = np.column_stack([up, heading, axis])
    # Contacts in MuJoCo are springs; twice the step is the stiffest that it allows.
    model = mujoco.MjModel.from_xml_string(WORLD.format(step=step, softness=max(2.5 * step, 2e-4)))
    data = mujoco.MjData(model)
    data.qpos[:3] = up
    mujoco.mju_mat2Quat(data.qpos[3:], attitude.ravel())
    data.qvel[:3] = np.cross(turning, up)
    data.qvel[3:] = attitude.T @ turning
    tilt, chi = [np.pi / 2 - phi], [0.0]
    for _ in range(round(t_end / step)):
        mujoco.mj_step(model, data)
        x, y, z = data.xmat[1].reshape(3, 3)[:, 2]
        tilt.append(np.arccos(min(z, 1.0)))
        chi.append(np.arctan2(-x, y))
    return np.arange(len(tilt)) * step, np.array(tilt), np.unwrap(chi)


def main():
    """Print the turn of the contact point and the tilt after the race, exact and for three steps."""
    disk = ex.Disk.uniform()
    start = ex.coordinates_to_states(disk, phi=np.pi / 2 - 0.2, phidot=1.0, sigma3_bar=0.5, eta_hat=1e-2)
    t_end = 2 * ex.bounces(start).time.item()
    exact = ex.simulate(start, t_end, t_eval=[t_end])
    print(f"exact:     turn {exact.chi.item() / np.pi:.3f} pi, then tilt {np.pi / 2 - exact.phi.item():.3f}")
    for step in (1e-3, 1e-4, 2e-5):
        _, tilt, chi = follow(start, step, t_end)
        print(f"step {step:g}: turn {chi[-1] / np.pi:.3f} pi, then tilt {tilt[-1]:.3f}")


if __name__ == "__main__":
    main()
