// SPDX-License-Identifier: Apache-2.0
#include "twin/recorded_rod.h"

#include <fmt/format.h>

#include <algorithm>

#include "twin/checks/objects.h"
#include "twin/column_names.h"
#include "twin/error.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

void ExpectWhole(const NpzFields& fields, const Recording& recording) {
  const std::vector<int> part = RodParts(recording.rod);
  for (int i = 0; i < recording.particle_count(); ++i) {
    if (part[i] < 0)
      fields.Fail("rod", fmt::format("has no edge of {}", NameOfColumn(recording, i)));
    if (part[i] == part[0] || recording.object.size() > 0) continue;
    fields.Fail("rod", fmt::format("joins {} to {} by no way; the array 'object' declares several "
                                   "objects",
                                   NameOfColumn(recording, 0), NameOfColumn(recording, i)));
  }
  for (const auto& [a, b] : recording.rod.edges) {
    if (b >= recording.object.size() || recording.object[a] == recording.object[b]) continue;
    fields.Fail("rod", fmt::format("joins {} to {}, which are of two objects",
                                   NameOfColumn(recording, a), NameOfColumn(recording, b)));
  }
}

// Whether a column is one of those that `order` puts on the rod.
bool IsPart(const Recording& recording, int column) {
  const int controller = column - recording.particle_count();
  return controller < 0 || recording.held.size() == 0 || recording.held.col(controller).all();
}

// By arc lengths, of each object.
RodEdges EdgesByOrder(const Recording& recording) {
  RodEdges edges;
  for (int object = 0; object < ObjectCount(recording); ++object) {
    std::vector<int> columns;
    for (int i = 0; i < recording.rod.arc.size(); ++i) {
      const bool own = recording.object.size() == 0 || recording.object[i] == object;
      if (own && IsPart(recording, i)) columns.push_back(i);
    }
    const RodEdges own = ChainEdges(recording.rod.arc, columns);
    edges.insert(edges.end(), own.begin(), own.end());
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace

RodEdges ReadRodEdges(NpzFields& fields, Eigen::Index columns) {
  const std::vector<int> ends = fields.Ints("rod", {"edges", "2"});
  try {
    return EdgesOfEnds(ends, columns);
  } catch (const Error& error) {
    fields.Fail("rod", error.what());
  }
}

NpzArray StoreRodEdges(const RodEdges& edges) {
  return NpzArray::Ints({edges.size(), 2}, edges.empty() ? nullptr : edges.data()->data());
}

void ReadRod(NpzFields& fields, Recording* recording) {
  if (fields.Has("order") && fields.Has("rod")) {
    fields.Fail("rod", "stands beside 'order', expected one of both");
  }
  if (fields.Has("order")) {
    recording->rod = PlainRod(fields.Vector("order", "N+M+C"));
  } else if (fields.Has("rod")) {
    recording->rod = RodOfEdges(ReadRodEdges(fields, recording->rest.cols()), recording->rest);
    ExpectWhole(fields, *recording);
  }
}

double ArcLengthAt(const Recording& recording, const Eigen::Vector3d& place) {
  const NeighbourSearch search(Points(recording.start.leftCols(recording.particle_count())));
  const std::vector<Neighbour> nearest = search.Nearest(place, 2);
  const RodLengths lengths(recording.rod);
  double sum = 0, weights = 0;
  for (const Neighbour& one : nearest) {
    if (weights > 0 && !lengths.Along(nearest[0].index, one.index)) break;
    const double weight = 1 / (one.distance + 1e-9);
    sum += weight * recording.rod.arc[one.index];
    weights += weight;
  }
  return sum / weights;
}

void KeepHoldingControllers(const Recording& recording, Rod* rod) {
  if (rod->empty()) return;
  for (int i = recording.particle_count(); i < rod->arc.size(); ++i) {
    if (!IsPart(recording, i)) TakeOut(i, rod);
  }
}

void CutRodBetweenObjects(Recording* recording) {
  if (recording->object.size() == 0) return;
  if (IsPlain(recording->rod)) {
    recording->rod.edges = EdgesByOrder(*recording);
  } else {
    std::erase_if(recording->rod.edges, [&](const std::array<int, 2>& edge) {
      return recording->object[edge[0]] != recording->object[edge[1]];
    });
  }
}

void StoreRod(const Recording& recording, Npz* arrays) {
  const Rod& rod = recording.rod;
  if (rod.empty()) return;
  if (rod.edges == EdgesByOrder(recording)) {
    (*arrays)["order"] = NpzArray::Doubles({ExtentOf(rod.arc.size())}, rod.arc.data());
  } else {
    (*arrays)["rod"] = StoreRodEdges(rod.edges);
  }
}

}  // namespace physpring
