# SPDX-License-Identifier: Apache-2.0
"""Spring-Gaus (Zhong et al., ECCV 2024) as a predictor of particles.

Anchors are joined to their k nearest ones. A spring of stiffness k_i / l0 pulls with
  F = k (l - l0) (1 + |l / l0 - 1|)^0.5,
weakened from the 17th neighbour on by one learned number (softness); dashpots have one constant.
What is on the ground keeps a learned part of its tangential velocity. Each anchor has a stiffness
(log10, Adam), masses are alike: as published (config/mpm_synthetic/default.yaml).

Different here: hands hold anchors (theirs only fall), which move as the controllers do, joined to
their k nearest anchors by such springs; the loss is of tracked particles, not of pictures; stiffness
is in our units, so that its start is searched for (`STARTS`), and the gradient's horizon is a few
frames, as one through all of them does not fit the time.
"""

import copy

import torch

NEIGHBOURS, FIXED, POWER = 256, 16, 0.5
STARTS = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)  # stiffness k, in N for 1 g an anchor
DAMPING_TIME = 1e-4  # s: dashpot constant by stiffness, as theirs
SUBSTEPS = 100  # a frame
LANES = 16  # numbers of neighbours are multiples of it: others are thirty times as slow
EPOCHS, HORIZON, RATES = 5, 7, (0.03, 0.1)


@torch.compile(dynamic=False)
def step(x, v, held, held_v, network, forces, ground, h):
    """One sub-step of h s. x, v: anchors (n,3); held, held_v: hands (c,3); network: neighbours and
    rest lengths (n,k); forces: stiffness N/m, dashpots N s/m (n,k), gravity (3), mass of an anchor;
    ground: its height and the part of the velocity that is kept on it, or none."""
    near, rest = network
    stiffness, damping, gravity, mass = forces
    everything, all_v = torch.cat([x, held]), torch.cat([v, held_v])
    offset = everything[near] - x[:, None]
    length = offset.norm(dim=2) + 1e-12
    way = offset / length[..., None]
    stretch = length / rest - 1
    force = stiffness * (length - rest) * (1 + stretch.abs()) ** POWER
    force = force + damping * ((all_v[near] - v[:, None]) * way).sum(2)
    v = v + h * ((force[..., None] * way).sum(1) / mass + gravity)
    x = x + h * v
    if ground is None:
        return x, v
    height, keep = ground
    below = (x[:, 2:] <= height).float()
    sliding = torch.cat([keep, keep, torch.zeros(1)])
    v = v * (1 - below) + below * sliding * v
    return torch.cat([x[:, :2], torch.maximum(x[:, 2:], height)], 1), v


class SpringGaus(torch.nn.Module):
    def __init__(self, recorded, start_stiffness):
        super().__init__()
        self.recorded = recorded
        self.anchors = recorded.start
        held = recorded.controllers[0]
        self.free = len(self.anchors)
        everything = torch.cat([self.anchors, held])
        neighbours = min(NEIGHBOURS, len(everything) - 1)
        neighbours -= neighbours % LANES if neighbours > LANES else 0
        length, near = torch.cdist(self.anchors, everything).topk(neighbours + 1, largest=False)
        self.length, self.near = length[:, 1:].clamp(min=1e-6), near[:, 1:]
        self.mass = torch.tensor(recorded.mass / self.free)
        scale = start_stiffness * float(self.mass) * 1e3
        self.log_stiffness = torch.nn.Parameter(
            torch.full((self.free,), float(torch.log10(torch.tensor(scale)))))
        self.softness = torch.nn.Parameter(torch.zeros(1))
        self.friction = torch.nn.Parameter(torch.full((1,), -1.0))
        self.log_damping = torch.nn.Parameter(torch.log10(torch.tensor([DAMPING_TIME])))

    def springs(self):
        """Stiffness (n,k) in N/m, dashpots in N s/m."""
        count = self.near.shape[1]
        k = 10 ** self.log_stiffness[:, None] / self.length
        if count > FIXED:
            step = torch.arange(count - FIXED) / (count - FIXED)
            soft = (2 - torch.exp(torch.nn.functional.softplus(self.softness)) ** step).clamp(0, 1)
            k = k * torch.cat([torch.ones(FIXED), soft])
        return k, k * 10 ** self.log_damping

    def frame(self, x, v, t, substeps):
        """From frame t to t + 1."""
        one, other = self.recorded.controllers[t], self.recorded.controllers[t + 1]
        h = torch.tensor(1 / self.recorded.fps / substeps)
        held_v = (other - one) * self.recorded.fps
        network = (self.near, self.length)
        forces = (*self.springs(), self.recorded.gravity, self.mass)
        ground = self.ground()
        for i in range(substeps):
            held = one + (other - one) * (i / substeps)
            x, v = step(x, v, held, held_v, network, forces, ground, h)
        return x, v

    def ground(self):
        if self.recorded.ground is None:
            return None
        keep = (1.2 * torch.sigmoid(self.friction) - 0.1).clamp(0, 1)
        return torch.tensor(self.recorded.ground), keep

    def rollout(self, frames, substeps):
        x, v = self.anchors, torch.zeros_like(self.anchors)
        states = [x]
        for t in range(frames - 1):
            x, v = self.frame(x, v, t, substeps)
            states.append(x)
        return torch.stack(states)


def loss_of(x, measured):
    seen = ~measured.isnan().any(1)
    return (x[:len(measured)][seen] - measured[seen]).square().sum(1).mean()


def mean_square(model, frames):
    """Of the distances over the first frames, predicted from the start on."""
    with torch.no_grad():
        states = model.rollout(frames, SUBSTEPS)
    losses = [loss_of(states[t], model.recorded.points[t]) for t in range(1, frames)]
    return float(torch.stack(losses).mean()) if bool(states.isfinite().all()) else float("inf")


def run_epoch(model, optimizer):
    """False: it became unstable."""
    recorded = model.recorded
    x, v = model.anchors, torch.zeros_like(model.anchors)
    loss = 0.0
    for t in range(recorded.train_frames - 1):
        x, v = model.frame(x, v, t, SUBSTEPS)
        loss = loss + loss_of(x, recorded.points[t + 1])
        if (t + 1) % HORIZON == 0 or t == recorded.train_frames - 2:
            if not torch.isfinite(loss):
                return False
            optimizer.zero_grad()
            loss.backward()
            torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
            optimizer.step()
            x, v, loss = x.detach(), v.detach(), 0.0
    return True


def predict(recorded, say, others=()):
    """Particles in all frames (T,N+M,3). The start is the one that predicts the frames for fitting
    best; then, of all rates and epochs, those parameters are kept that predict them best."""
    scores = {start: mean_square(SpringGaus(recorded, start), recorded.train_frames)
              for start in STARTS}
    for start, score in scores.items():
        say(f"start {start:g}: {1e3 * score ** 0.5:.1f} mm")
    start = min(scores, key=scores.get)
    if scores[start] == float("inf"):
        raise RuntimeError("unstable from every start")
    best, kept = scores[start], SpringGaus(recorded, start)
    for rate in RATES:
        model = SpringGaus(recorded, start)
        optimizer = torch.optim.Adam(model.parameters(), lr=rate)
        for epoch in range(EPOCHS):
            if not run_epoch(model, optimizer):
                break
            score = mean_square(model, recorded.train_frames)
            say(f"rate {rate:g}, epoch {epoch}: {1e3 * score ** 0.5:.1f} mm")
            if score < best:
                best, kept = score, copy.deepcopy(model)
    with torch.no_grad():
        return kept.rollout(recorded.frames, SUBSTEPS)
