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

import torch

NEIGHBOURS, FIXED, POWER = 256, 16, 0.5
STARTS = (0.3, 1.0, 3.0, 10.0, 30.0)  # stiffness k, in N for 1 g an anchor
DAMPING_TIME = 1e-4  # s: dashpot constant by stiffness, as theirs
SUBSTEPS = 100  # a frame
EPOCHS, HORIZON, RATE = 2, 2, 0.03


class SpringGaus(torch.nn.Module):
    def __init__(self, recorded, start_stiffness):
        super().__init__()
        self.recorded = recorded
        self.anchors = recorded.start
        held = recorded.controllers[0]
        self.free = len(self.anchors)
        everything = torch.cat([self.anchors, held])
        neighbours = min(NEIGHBOURS, len(everything) - 1)
        length, near = torch.cdist(self.anchors, everything).topk(neighbours + 1, largest=False)
        self.length, self.near = length[:, 1:].clamp(min=1e-6), near[:, 1:]
        self.mass = recorded.mass / self.free
        scale = start_stiffness * self.mass * 1e3
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

    def step(self, x, v, held, held_v, springs, h):
        stiffness, damping = springs
        everything, all_v = torch.cat([x, held]), torch.cat([v, held_v])
        offset = everything[self.near] - x[:, None]
        length = offset.norm(dim=2) + 1e-12
        way = offset / length[..., None]
        stretch = length / self.length - 1
        force = stiffness * (length - self.length) * (1 + stretch.abs()) ** POWER
        force = force + damping * ((all_v[self.near] - v[:, None]) * way).sum(2)
        v = v + h * ((force[..., None] * way).sum(1) / self.mass + self.recorded.gravity)
        x = x + h * v
        if self.recorded.ground is None:
            return x, v
        below = (x[:, 2:] <= self.recorded.ground).float()
        keep = (1.2 * torch.sigmoid(self.friction) - 0.1).clamp(0, 1)
        sliding = torch.cat([keep, keep, torch.zeros(1)])
        v = v * (1 - below) + below * sliding * v
        x = torch.cat([x[:, :2], torch.maximum(x[:, 2:], torch.tensor(self.recorded.ground))], 1)
        return x, v

    def frame(self, x, v, t, substeps):
        """From frame t to t + 1."""
        one, other = self.recorded.controllers[t], self.recorded.controllers[t + 1]
        h = 1 / self.recorded.fps / substeps
        held_v = (other - one) * self.recorded.fps
        springs = self.springs()
        for i in range(substeps):
            held = one + (other - one) * (i / substeps)
            x, v = self.step(x, v, held, held_v, springs, h)
        return x, v

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
    """Particles in all frames (T,N+M,3). The start is the one that predicts the first third of the
    frames for fitting best; then those parameters are kept that predict all of them best."""
    scores = {start: mean_square(SpringGaus(recorded, start), recorded.train_frames // 3)
              for start in STARTS}
    for start, score in scores.items():
        say(f"start {start:g}: {1e3 * score ** 0.5:.1f} mm")
    start = min(scores, key=scores.get)
    if scores[start] == float("inf"):
        raise RuntimeError("unstable from every start")
    model = SpringGaus(recorded, start)
    optimizer = torch.optim.Adam(model.parameters(), lr=RATE)
    best, kept = float("inf"), None
    for epoch in range(EPOCHS + 1):
        score = mean_square(model, recorded.train_frames)
        say(f"epoch {epoch}: {1e3 * score ** 0.5:.1f} mm")
        if score < best:
            best, kept = score, {key: value.clone() for key, value in model.state_dict().items()}
        if epoch == EPOCHS or not run_epoch(model, optimizer):
            break
    model.load_state_dict(kept)
    with torch.no_grad():
        return model.rollout(recorded.frames, SUBSTEPS)
