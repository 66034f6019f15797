"""Poses a person by angles and places of the feet. Metres and radians; room frame: Y up, the floor is y = 0."""

import numpy as np

X, Y, Z = np.eye(3)


def rotation(axis, angle):
    """[3 x 3] about a unit axis (Rodrigues)."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def unit(v):
    return v / np.linalg.norm(v)


def frame_of(direction, side):
    """[3 x 3] orthonormal, first column along direction, second as near to side as can be."""
    d = unit(direction)
    n = unit(side - d * (side @ d))
    return np.stack([d, n, np.cross(d, n)], axis=1)


def turn_between(direction, side, to_direction, to_side):
    return frame_of(to_direction, to_side) @ frame_of(direction, side).T


class Poser:
    """Global rotations of all bones (identity at rest) and where joints are, for a posture (motions.py)."""

    def __init__(self, actor):
        self.actor = actor
        self.at = {name: i for i, name in enumerate(actor.names)}
        rest = lambda name: actor.joints[self.at[name]]
        self.hips_height = rest("Hips")[1]
        self.ankles = [rest(f"{side}Foot") for side in ("Left", "Right")]

    def stance(self, side, x, z, yaw):
        """Where the ankle is at rest for someone who stands at (x, z), turned by yaw."""
        hips = self.actor.joints[self.at["Hips"]]
        offset = self.ankles[side] - np.array([hips[0], 0, hips[2]])
        return np.array([x, 0, z]) + rotation(Y, yaw) @ offset

    def pose(self, posture, feet):
        """feet: two (ankle [3], yaw, toes_down). Returns rotations [bones x 3 x 3], joints [bones x 3]."""
        actor, at = self.actor, self.at
        turned = {}
        hips = rotation(Y, posture["yaw"]) @ rotation(X, posture["lean"]) @ rotation(Z, posture["tilt"])
        place = np.array([posture["x"], self.hips_height - posture["dip"], posture["z"]])
        turned[at["Hips"]] = hips
        trunk = hips
        third = rotation(Y, posture["twist"] / 3) @ rotation(X, posture["bend"] / 3)
        for name in ("Spine", "Spine1", "Spine2"):
            trunk = trunk @ third
            turned[at[name]] = trunk
        turned[at["Neck"]] = trunk @ rotation(Y, posture["look"] / 2)
        turned[at["Head"]] = trunk @ rotation(Y, posture["look"])
        for side, name in enumerate(("Left", "Right")):
            self._turn_arm(name, 1 - 2 * side, posture["arms"][side], trunk, turned)
            hip = place + hips @ (actor.joints[at[f"{name}UpLeg"]] - actor.joints[at["Hips"]])
            self._turn_leg(name, 1 - 2 * side, hip, hips, feet[side], turned)
        return self._chain(turned, place)

    def _turn_arm(self, name, sign, arm, trunk, turned):
        abduction, flexion, elbow = arm
        rest = lambda part: self.actor.joints[self.at[name + part]]
        upper, lower = rest("ForeArm") - rest("Arm"), rest("Hand") - rest("ForeArm")
        collar = trunk @ rotation(Z, sign * 0.25 * max(abduction - 1.2, 0))
        turned[self.at[f"{name}Shoulder"]] = collar
        at_rest = rotation(Z, sign * np.arctan2(abs(upper[0]), -upper[1]))
        wanted = rotation(X, -flexion) @ rotation(Z, sign * abduction)
        down, hinge = -Y, -X
        turn = turn_between(upper, at_rest @ hinge, wanted @ down, wanted @ hinge)
        turned[self.at[f"{name}Arm"]] = trunk @ turn
        bent = wanted @ rotation(hinge, elbow)
        turned[self.at[f"{name}ForeArm"]] = trunk @ turn_between(lower, at_rest @ hinge, bent @ down, bent @ hinge)

    def _turn_leg(self, name, sign, hip, hips, foot, turned):
        ankle, yaw, toes_down = foot
        rest = lambda part: self.actor.joints[self.at[name + part]]
        thigh, shin = rest("Leg") - rest("UpLeg"), rest("Foot") - rest("Leg")
        a, b = np.linalg.norm(thigh), np.linalg.norm(shin)
        reach = min(np.linalg.norm(ankle - hip), 0.9995 * (a + b))
        down = unit(ankle - hip)
        knee_forward = 0.2 * hips @ rotation(Y, sign * 0.15) @ Z + 0.8 * rotation(Y, yaw) @ Z
        hinge = unit(np.cross(knee_forward, down))
        along = (a * a - b * b + reach * reach) / (2 * reach)
        out = np.sqrt(max(a * a - along * along, 0))
        knee = hip + down * along + np.cross(down, hinge) * out
        turned[self.at[f"{name}UpLeg"]] = turn_between(thigh, X, knee - hip, hinge)
        turned[self.at[f"{name}Leg"]] = turn_between(shin, X, hip + down * reach - knee, hinge)
        turned[self.at[f"{name}Foot"]] = rotation(Y, yaw) @ rotation(X, toes_down)

    def _chain(self, turned, place):
        actor = self.actor
        rotations, joints = np.empty((len(actor.names), 3, 3)), np.empty((len(actor.names), 3))
        for bone, parent in enumerate(actor.parents):
            rotations[bone] = turned.get(bone, rotations[parent] if parent >= 0 else np.eye(3))
            joints[bone] = place if parent < 0 else joints[parent] + rotations[parent] @ (
                actor.joints[bone] - actor.joints[parent])
        return rotations, joints

    def skinned(self, rotations, joints):
        """[n x 3] linear blend skinning."""
        offsets = joints - np.einsum("bij,bj->bi", rotations, self.actor.joints)
        blended = np.einsum("nb,bij->nij", self.actor.weights, rotations)
        return np.einsum("nij,nj->ni", blended, self.actor.vertices) + self.actor.weights @ offsets
