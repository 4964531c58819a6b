# SPDX-License-Identifier: Apache-2.0
"""What learned dynamics of particles have in common: graphs, training by rollouts, prediction."""

import torch

from .recorded import carried, farthest_points

FUTURE, BATCH = 5, 8  # frames of a training rollout
NOISE = 0.003  # m, of the positions that training begins with
CONTROLLERS = 12  # at most, evenly apart


class Graph:
    """A few points of the object and of the hands, and who is near whom."""

    def __init__(self, recorded, spacing, reach, most, neighbours):
        self.recorded = recorded
        start = recorded.points[0]
        self.chosen = farthest_points(start, spacing, most)
        self.held = farthest_points(recorded.controllers[0], 1e-6, CONTROLLERS)
        self.states = recorded.filled()[:, self.chosen]  # (T,n,3)
        self.hands = recorded.controllers[:, self.held]  # (T,c,3)
        self.reach, self.neighbours = reach, neighbours
        self.object = len(self.chosen)

    def kinds(self):
        """(n+c,2): which are of the object, which of hands."""
        kinds = torch.zeros(self.object + len(self.held), 2)
        kinds[:self.object, 0] = 1
        kinds[self.object:, 1] = 1
        return kinds

    def edges(self, x):
        """(2,E): from sender to receiver, within reach, the nearest ones of each receiver, of
        positions (B,n+c,3); numbers count through the batch."""
        batch, count = x.shape[:2]
        near = min(self.neighbours + 1, count)
        distance, sender = torch.cdist(x, x).topk(near, largest=False)
        receiver = torch.arange(count).expand(batch, count)[..., None].expand_as(sender)
        within = (distance < self.reach) & (sender != receiver)
        offset = count * torch.arange(batch)[:, None, None]
        return torch.stack([(sender + offset)[within], (receiver + offset)[within]])


def train(model, graphs, history, seconds, rate, say):
    """Rollouts of FUTURE frames from anywhere in the frames for fitting of all graphs; the loss is the
    mean squared distance. Ends after `seconds`."""
    import time
    optimizer = torch.optim.Adam(model.parameters(), lr=rate)
    generator = torch.Generator().manual_seed(0)
    begin, steps, running = time.monotonic(), 0, None
    while (spent := time.monotonic() - begin) < seconds:
        for group in optimizer.param_groups:
            group["lr"] = rate * max(0.05, 1 - spent / seconds)
        graph = graphs[int(torch.randint(len(graphs), (1,), generator=generator))]
        last = graph.recorded.train_frames - FUTURE
        first = torch.randint(history - 1, last, (BATCH,), generator=generator)
        window = torch.stack([graph.states[f - history + 1:f + 1] for f in first])
        window = window + NOISE * torch.randn(window.shape, generator=generator)
        hands = torch.stack([graph.hands[f - history + 1:f + FUTURE + 1] for f in first])
        loss = 0
        for i in range(FUTURE):
            x = model(graph, window, hands[:, i:i + history + 1])
            target = torch.stack([graph.states[f + i + 1] for f in first])
            loss = loss + (x - target).square().sum(-1).mean()
            window = torch.cat([window[:, 1:], x[:, None]], 1)
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimizer.step()
        value = float(loss.detach())
        running = value if running is None else 0.98 * running + 0.02 * value
        steps += 1
        if steps % 100 == 0:
            say(f"step {steps}, {1e3 * (running / FUTURE) ** 0.5:.2f} mm, {spent:.0f} of {seconds} s")


@torch.no_grad()
def rollout(model, graph, history):
    """Particles in all frames (T,N+M,3), from frame 0 at rest."""
    recorded = graph.recorded
    window = graph.states[0].expand(1, history, -1, -1)
    frames = [graph.states[0]]
    for t in range(recorded.frames - 1):
        before = [graph.hands[max(0, t - history + 1 + i)] for i in range(history)]
        hands = torch.stack(before + [graph.hands[t + 1]])[None]
        x = model(graph, window, hands)
        frames.append(x[0])
        window = torch.cat([window[:, 1:], x[:, None]], 1)
    return carried(recorded.start, frames[0], torch.stack(frames))
