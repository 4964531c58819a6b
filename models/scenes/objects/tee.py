# SPDX-License-Identifier: Apache-2.0
"""Prints tee.xml: a stiff T as one flex, because MuJoCo has no grid of that shape."""
from itertools import permutations

H = 0.01  # m, edge of a cube; the vertices' radius adds 6 mm to each side
BAR = [(i, j, k) for i in range(15) for j in range(4) for k in range(3)]
STEM = [(i, j, k) for i in range(6, 9) for j in range(-11, 0) for k in range(3)]
HELD = [(i, j, 3) for j in (-11, -10) for i in range(6, 10)]  # on top of the stem's end
START = 0.006  # m, height of the lowest vertices

# six tetrahedra a cube: one for each way along its edges from one corner to the opposite one
vertex, tetrahedra = {}, []
for cube in BAR + STEM:
    for order in permutations(range(3)):
        corner, way = list(cube), []
        for axis in (None, *order):
            if axis is not None:
                corner[axis] += 1
            way.append(vertex.setdefault(tuple(corner), len(vertex)))
        odd = order in ((0, 2, 1), (1, 0, 2), (2, 1, 0))
        tetrahedra.append([way[0], way[2], way[1], way[3]] if odd else way)

centre = [sum(v[axis] for v in vertex) / len(vertex) for axis in range(3)]
points = [[H * (v[0] - centre[0]), H * (v[1] - centre[1]), START + H * v[2]] for v in vertex]
hand = [sum(points[vertex[v]][axis] for v in HELD) / len(HELD) for axis in range(3)]


def text(rows, form):
    return ' '.join(form % number for row in rows for number in row)


def at(x, y, z):
    return '%.4f %.4f %.4f' % (hand[0] + x, hand[1] + y, hand[2] + z)


print(f'''<!-- A stiff T of 0.16 x 0.16 x 0.04 m and 150 g, lifted at its stem and shaken. Printed by tee.py. -->
<mujoco model="tee">
  <option timestep="0.002" integrator="discrete" solver="CG" iterations="500"/>

  <default>
    <equality solref="0.004 1" solimp="0.99 0.999 0.001"/>
  </default>

  <worldbody>
    <light pos="0 0 2"/>
    <geom name="floor" type="plane" size="2 2 0.1"/>
    <body name="hand" mocap="true" pos="{at(0, 0, 0)}">
      <geom type="sphere" size="0.012" contype="0" conaffinity="0" rgba="0.8 0.3 0.2 0.5"/>
    </body>
    <flexcomp name="tee" type="direct" dim="3" mass="0.15" radius="0.006"
              point="{text(points, '%.5f')}"
              element="{text(tetrahedra, '%d')}">
      <elasticity young="2e5" poisson="0.2" damping="0.01"/>
      <contact selfcollide="none" friction="0.5" solref="0.005 1"/>
    </flexcomp>
  </worldbody>

  <equality>''')
for v in HELD:
    print(f'    <connect body1="tee_{vertex[v]}" body2="hand" anchor="0 0 0"/>')
print(f'''  </equality>

  <keyframe>
    <key time="0" mpos="{at(0, 0, 0)}"/>
    <key time="0.5" mpos="{at(0, 0.02, 0.08)}" mquat="0.98 -0.1 0.1 0"/>
    <key time="0.9" mpos="{at(0.05, 0, 0.1)}" mquat="0.98 0.1 -0.1 0.1"/>
    <key time="1.3" mpos="{at(0, -0.03, 0.01)}"/>
    <key time="1.7" mpos="{at(-0.06, -0.05, 0.005)}" mquat="0.99 0 0 0.1"/>
    <key time="2.2" mpos="{at(0, 0.02, 0.08)}" mquat="0.98 0.1 0.1 0"/>
  </keyframe>
</mujoco>''')
