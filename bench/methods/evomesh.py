# SPDX-License-Identifier: Apache-2.0
"""EvoMesh (Deng et al., ICML 2025) as a predictor of particles.

A U-net of graphs. On the way down each level passes messages that are weighted by what they say
(softmax over a receiver's edges), decides by a Gumbel softmax which nodes the next level keeps, and
joins what was two steps apart; on the way up nodes that were left out get their features back through
the same weights. Nodes know their velocity and kind, edges both offsets, in the world and at rest.
The output is a change of velocity: as published (src/core_model.py, src/models.py of its authors).

Different here: two levels, 64 features and a time limit, on a CPU; rollouts of five frames as the loss
(theirs: one step with noise), which is kinder to long predictions; edges to the hands are found anew
in each frame. It gets other recordings of the object beside the one.
"""

import torch

from .graph_dynamics import Graph, rollout, train

HISTORY, FEATURES, LEVELS = 2, 64, 2
NEIGHBOURS, MOST = 6, 200
RATE = 5e-4
WARMEST, COLDEST, COOLING = 5.0, 0.1, 0.999  # of the Gumbel softmax


def mlp(inputs, outputs, normal=True):
    layers = [torch.nn.Linear(inputs, FEATURES), torch.nn.ReLU(),
              torch.nn.Linear(FEATURES, FEATURES), torch.nn.ReLU(),
              torch.nn.Linear(FEATURES, outputs)]
    return torch.nn.Sequential(*layers, *([torch.nn.LayerNorm(outputs)] if normal else []))


def softmax_over(values, group, groups):
    """Of values (E,1), those of one group sum to 1."""
    most = torch.full((groups, 1), -1e9).scatter_reduce(0, group[:, None], values, "amax")
    power = (values - most[group].detach()).exp()
    return power / torch.zeros(groups, 1).index_add(0, group, power)[group].clamp(min=1e-12)


class Messages(torch.nn.Module):
    """One round; returns features and the edges' weights."""

    def __init__(self):
        super().__init__()
        self.edge = mlp(2 * FEATURES + 8, FEATURES)
        self.weight = mlp(FEATURES, 1, normal=False)
        self.node = mlp(2 * FEATURES, FEATURES)

    def forward(self, h, edges, x, rest):
        sender, receiver = edges
        world, body = x[sender] - x[receiver], rest[sender] - rest[receiver]
        offsets = torch.cat([world, body, world.norm(dim=1, keepdim=True),
                             body.norm(dim=1, keepdim=True)], 1)
        message = self.edge(torch.cat([offsets, h[sender], h[receiver]], 1))
        weight = softmax_over(self.weight(message), receiver, len(h))
        gathered = torch.zeros_like(h).index_add(0, receiver, weight * message)
        both = torch.cat([h, gathered], 1)
        return h + self.node(both), weight, both


class EvoMesh(torch.nn.Module):
    def __init__(self):
        super().__init__()
        self.encode, self.decode = mlp(3 + 2, FEATURES), mlp(FEATURES, 3, normal=False)
        self.down = torch.nn.ModuleList(Messages() for _ in range(LEVELS))
        self.up = torch.nn.ModuleList(Messages() for _ in range(LEVELS))
        self.bottom = Messages()
        self.keep = torch.nn.ModuleList(mlp(2 * FEATURES, 2, normal=False) for _ in range(LEVELS))
        self.temperature = WARMEST

    def kept(self, level, both):
        """How much of each node the next level has: 1 or 0, with the gradient of the soft choice."""
        logits = self.keep[level](both)
        if self.training:
            self.temperature = max(COLDEST, self.temperature * COOLING)
            chosen = torch.nn.functional.gumbel_softmax(logits, self.temperature, hard=True)[:, 0]
        else:
            chosen = (logits[:, 0] >= logits[:, 1]).float()
        if chosen.sum() < 2:  # a level needs some
            chosen = torch.ones_like(chosen)
        return chosen

    def forward(self, graph, window, hands):
        batch = len(window)
        x = torch.cat([window[:, -1], hands[:, -1]], 1)
        count = x.shape[1]
        velocity = torch.cat([window[:, -1] - window[:, -2], hands[:, -1] - hands[:, -2]], 1)
        kinds = graph.kinds().expand(batch, -1, -1)
        rest = torch.cat([graph.states[0], graph.hands[0]]).expand(batch, -1, -1)
        edges = graph.edges(x)
        loops = torch.arange(batch * count)
        edges = torch.cat([edges, torch.stack([loops, loops])], 1)
        scale = graph.reach
        h = self.encode(torch.cat([velocity / scale * 10, kinds], 2).reshape(batch * count, 5))
        h = self.process(h, edges, x.reshape(-1, 3) / scale, rest.reshape(-1, 3) / scale)
        change = self.decode(h).reshape(batch, count, 3)[:, :graph.object] * (scale / 10)
        return window[:, -1] + velocity[:, :graph.object] + change

    def process(self, h, edges, x, rest):
        passed = []
        for level in range(LEVELS):
            h, weight, both = self.down[level](h, edges, x, rest)
            chosen = self.kept(level, both)
            index = chosen.detach().nonzero()[:, 0]
            passed.append((h, edges, x, rest, weight, index))
            sender, receiver = edges
            h = torch.zeros_like(h).index_add(0, receiver, weight * h[sender])
            h = (h * chosen[:, None])[index]
            x, rest = x[index], rest[index]
            edges = self.coarse(edges, index, len(chosen))
        h, _, _ = self.bottom(h, edges, x, rest)
        for level in reversed(range(LEVELS)):
            finer, edges, x, rest, weight, index = passed[level]
            spread = torch.zeros_like(finer).index_copy(0, index, h)
            sender, receiver = edges
            spread = torch.zeros_like(finer).index_add(0, sender, weight * spread[receiver])
            h, _, _ = self.up[level](spread, edges, x, rest)
            h = h + finer
        return h

    @staticmethod
    def coarse(edges, index, count):
        """Edges among the kept nodes: those of one or two steps."""
        ones = torch.ones(edges.shape[1])
        matrix = torch.sparse_coo_tensor(edges, ones, (count, count)).coalesce()
        two = torch.sparse.mm(matrix, matrix).coalesce().indices()
        place = torch.full((count,), -1)
        place[index] = torch.arange(len(index))
        found = place[two]
        return found[:, (found >= 0).all(0)]


def predict(recorded, say, others=(), seconds=300):
    torch.manual_seed(0)
    size = float((recorded.start.max(0).values - recorded.start.min(0).values).norm())
    spacing = size / 30
    graphs = [Graph(one, spacing, 2.7 * spacing, MOST, NEIGHBOURS) for one in (recorded, *others)]
    model = EvoMesh()
    train(model, graphs, HISTORY, seconds, RATE, say)
    model.eval()
    return rollout(model, graphs[0], HISTORY)
