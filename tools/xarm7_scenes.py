#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Puts an xArm7 into tasks: xarm7_scenes.py SCENES ROBOSUITE OUTPUT [--joints]

SCENES is models/scenes, ROBOSUITE what scripts/xarm7 keeps of the package, OUTPUT gets a folder for
each task. The arm's flange carries the hand of the task's scene, in place of its free joint, so the
weld to the mocap body `target` moves the arm, and task.json stays as it is. What touches the object
is the hand's as well: the pads of the floating gripper, on slides. The arm's own linkage only
follows them, by joint equalities: its fingers are coarse boxes in MuJoCo that nodes slip past.

With --joints, servos in the arm's joints move it instead of the weld: an action is seven angles and
the fingers' control. The scripted policies, which move the hand, cannot drive these tasks.
"""
import argparse
import copy
import json
import math
import os
import pathlib
import xml.etree.ElementTree as ET

# degrees, of joint1 to joint7: the flange points down
START = (0, -11, 0, 46, 0, 57, 0)
# m, where the hand is then
TARGET = '0.40108 0 0.19709'
# m, from the flange to between the pads
HAND = 0.149
# m: the shoulder's height; from there to the elbow and on to the wrist, along and across; from the
# wrist to the flange
SHOULDER = 0.267
UPPER, FORE, WRIST = (0.293, 0.0525), (0.3425, 0.0775), (0.097, 0.076)
ARM = tuple(f'xarm7_joint{i}' for i in range(1, 8))
# Of the servos in joint1 to joint7, N m/rad. All lag by the same time (s), so the hand keeps to its
# path; with less they overshoot, as the torque of robosuite's motors (N m) has its limit.
STIFFNESS = (8000, 8000, 6000, 6000, 2000, 2000, 2000)
LAG = 0.05
TORQUE = 80
# The gripper's driver (rad) of the pads' slide (m), so that finger and pad face move alike: from
# the linkage's lengths, fitted to 1e-4 rad.
DRIVER = '0.101962491 21.9235965 -143.803046 2295.29934 -11970.7935'


def times(a, b):
    """The product of two quaternions w x y z."""
    return (a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0])


def angles_down(x, y, z, yaw):
    """The angles (rad) of joint1 to joint7 for a hand at x, y, z (m) that points down, turned by
    `yaw` (rad) about the vertical. The arm stays in a plane. Too far: a ValueError."""
    turned = math.atan2(y, x)
    reach = math.hypot(x, y) - WRIST[1]
    rise = z + HAND + WRIST[0] - SHOULDER
    upper, fore, whole = math.hypot(*UPPER), math.hypot(*FORE), math.hypot(reach, rise)
    # of the triangle shoulder, elbow, wrist: the angles at the first two
    shoulder = math.acos((upper**2 + whole**2 - fore**2) / (2 * upper * whole))
    elbow = math.acos((upper**2 + fore**2 - whole**2) / (2 * upper * fore))
    lean = math.pi / 2 - math.atan2(rise, reach) - shoulder - math.atan2(UPPER[1], UPPER[0])
    bend = elbow - math.atan2(UPPER[1], UPPER[0]) - math.atan2(FORE[1], FORE[0])  # 0: folded
    return (turned, lean, 0, bend, 0, bend - lean, turned - yaw)


def only_seen(body):
    """Takes from a body what is for other uses, and makes its geoms touch nothing."""
    for part in body.iter():
        for child in list(part):
            if child.tag in ('site', 'camera'):
                part.remove(child)
        if part.tag == 'body':
            part.set('gravcomp', '1')
        if part.tag == 'geom':
            part.attrib.pop('class', None)
            part.attrib.update(type='mesh', contype='0', conaffinity='0', group='2')


def meshes(root, folder, prefix):
    """The <asset> of a robosuite file, its files found from here, its names with a prefix."""
    asset = ET.Element('asset')
    for item in root.find('asset'):
        item = copy.deepcopy(item)
        item.set('name', prefix + item.get('name'))
        if item.tag == 'mesh':
            item.set('file', str(folder / item.get('file')))
        asset.append(item)
    for geom in root.iter('geom'):
        for key in ('mesh', 'material'):
            if key in geom.attrib:
                geom.set(key, prefix + geom.get(key))
    return asset


def read_arm(folder, start, servos):
    """Assets, the arm's base at its start (degrees), and its flange, to hang something on. With
    servos its joints keep their range."""
    root = ET.parse(folder / 'robot.xml').getroot()
    asset = meshes(root, folder, 'xarm7_')
    base = root.find("worldbody/body[@name='base']")
    flange = base.find(".//body[@name='link7']")
    flange.remove(flange.find("body[@name='right_hand']"))
    only_seen(base)
    for angle, joint in zip(start, base.iter('joint')):
        body = next(b for b in base.iter('body') if joint in list(b))
        quaternion = [float(x) for x in body.get('quat', '1 0 0 0').split()]
        half = math.radians(angle) / 2
        turned = times(quaternion, (math.cos(half), 0, 0, math.sin(half)))
        body.set('quat', ' '.join(repr(x) for x in turned))
        if servos:
            limits = (math.degrees(float(x)) for x in joint.get('range').split())
            own = {'range': ' '.join(repr(x) for x in limits), 'armature': '0.1'}
        else:  # the weld leaves the elbow free to swing: damped, and drawn to the arm's plane
            own = {'damping': '1', 'armature': '0.05'}
            if joint.get('name') == 'joint3':
                own.update(stiffness='5', springref='0')
        joint.attrib = {'name': 'xarm7_' + joint.get('name'), 'axis': joint.get('axis'),
                        'ref': str(angle), **own}
    for body in base.iter('body'):
        body.set('name', 'xarm7_' + body.get('name'))
    return asset, base, flange


def read_gripper(folder):
    """Assets, the gripper with its linkage, and the equalities by which the pads move it."""
    root = ET.parse(folder / 'xarm7_gripper.xml').getroot()
    asset = meshes(root, folder, 'xarm7_gripper_')
    gripper = root.find("worldbody/body[@name='xarm_gripper_base_link']")
    gripper.remove(gripper.find("body[@name='eef']"))
    for body in gripper.iter('body'):  # the pads of the hand take their place
        for geom in body.findall('geom'):
            if geom.get('class', '').startswith('pad'):
                body.remove(geom)
    only_seen(gripper)
    equality = ET.Element('equality')
    for part in gripper.findall('body'):  # so light that the pads do not feel it
        for body in part.iter('body'):
            body.remove(body.find('inertial'))
            for geom in body.findall('geom'):
                geom.set('mass', '0.0005')
    for joint in gripper.iter('joint'):
        name = 'xarm7_' + joint.get('name')
        joint.attrib = {'name': name, 'axis': joint.get('axis'), 'armature': '1e-5'}
        ET.SubElement(equality, 'joint', joint1=name, joint2='left_finger', polycoef=DRIVER,
                      solref='0.02 1')
    for body in gripper.iter('body'):
        body.set('name', 'xarm7_' + body.get('name'))
    gripper.set('pos', f'0 0 {HAND}')
    gripper.set('quat', '0 1 0 0')
    return asset, gripper, equality


def add_servos(model):
    """Servos in the arm's joints, in place of the weld to the mocap body."""
    world = next(w for w in model.iter('worldbody') if w.find("body[@name='target']") is not None)
    world.remove(world.find("body[@name='target']"))
    equality = model.find('equality')
    equality.remove(equality.find("weld[@name='hand']"))
    actuator = model.find('actuator')
    if actuator is None:
        actuator = ET.SubElement(model, 'actuator')
    for name, kp in zip(ARM, STIFFNESS):
        ET.SubElement(actuator, 'position', name=name, joint=name, kp=str(kp), kv=str(LAG * kp),
                      inheritrange='1', forcerange=f'{-TORQUE} {TORQUE}')


def with_arm(model, robosuite, start=START, servos=False):
    """Puts the arm, at its start (degrees), into a model with the bodies `target` and `hand`."""
    world = next(w for w in model.iter('worldbody') if w.find("body[@name='hand']") is not None)
    hand = world.find("body[@name='hand']")
    world.remove(hand)
    world.find("body[@name='target']").set('pos', TARGET)
    asset, base, flange = read_arm(robosuite / 'arm', start, servos)
    model.append(asset)
    hand.remove(hand.find('freejoint'))
    hand.set('pos', f'0 0 {HAND}')
    hand.set('quat', '0 1 0 0')
    if hand.find("body[@name='left_finger']") is not None:
        for name in ('palm', 'wrist'):
            hand.remove(hand.find(f"geom[@name='{name}']"))
        defaults = hand.attrib.pop('childclass')  # are for the fingers only
        for finger in hand.findall('body'):
            finger.set('childclass', defaults)
        asset, gripper, equality = read_gripper(robosuite / 'gripper')
        model.append(asset)
        model.append(equality)
        hand.append(gripper)
    flange.append(hand)
    world.append(base)
    if servos:
        add_servos(model)
    else:
        model.find("equality/weld[@name='hand']").set('relpose', '0 0 0 1 0 0 0')


def write(model, path):
    ET.indent(model)
    ET.ElementTree(model).write(path, encoding='unicode')


def drive_joints(settings):
    """Makes the robot of a task.json one that is driven by joints. Its home stays the same pose."""
    robot = settings['robot']
    x, y, z, qw, _, _, qz, gripper = robot['home']
    fingers, opened, closed = (robot.get(key, []) for key in ('actuators', 'open', 'closed'))
    at_home = [a + gripper * (b - a) for a, b in zip(opened, closed)]
    settings['robot'] = {'kind': 'joints', 'hand': robot['hand'], 'actuators': [*ARM, *fingers]}
    if fingers:
        settings['robot'].update(fingers=len(fingers), open=opened, closed=closed)
    angles = angles_down(x, y, z, 2 * math.atan2(qz, qw))
    settings['robot']['home'] = [*angles, *at_home]
    del settings['policy']
    return [math.degrees(angle) for angle in angles]


def make_task(task, robosuite, folder, joints):
    """The folder of a task with an arm; twin and levels stay where they are."""
    folder.mkdir(parents=True, exist_ok=True)

    def from_folder(path):
        return pathlib.Path(os.path.relpath(path, folder))

    scene = ET.parse(task / 'scene.xml').getroot()
    with_hand = scene
    for include in scene.iter('include'):
        included = task / include.get('file')
        include.set('file', str(from_folder(included)))
        if included.name == 'gripper.xml':
            with_hand = ET.parse(included).getroot()
            include.set('file', 'gripper.xml')
    settings = json.loads((task / 'task.json').read_text())
    if joints:
        with_arm(with_hand, robosuite, drive_joints(settings), servos=True)
    else:
        with_arm(with_hand, robosuite)
    for mesh in with_hand.iter('mesh'):
        mesh.set('file', str(from_folder(mesh.get('file'))))
    if with_hand is not scene:
        write(with_hand, folder / 'gripper.xml')
    write(scene, folder / 'scene.xml')
    settings['twin'] = str(from_folder(task / settings['twin']))
    settings['levels'] = [str(from_folder(task / level)) for level in settings['levels']]
    (folder / 'task.json').write_text(json.dumps(settings, indent=2) + '\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    for name in ('scenes', 'robosuite', 'output'):
        parser.add_argument(name, type=pathlib.Path)
    parser.add_argument('--joints', action='store_true', help='servos in the joints, no weld')
    arguments = parser.parse_args()
    for settings in sorted(arguments.scenes.glob('*/task.json')):
        task = settings.parent
        make_task(task, arguments.robosuite, arguments.output / task.name, arguments.joints)
        print(arguments.output / task.name)


if __name__ == '__main__':
    main()
