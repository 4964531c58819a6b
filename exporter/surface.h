// SPDX-License-Identifier: Apache-2.0
// A surface through or around points that came without one.
#ifndef PHYSPRING_EXPORTER_SURFACE_H_
#define PHYSPRING_EXPORTER_SURFACE_H_

#include "exporter/triangle_mesh.h"
#include "twin/points.h"

namespace physpring {

// Mean distance of the points (3 x points, m, at least 2) to their nearest neighbours.
double Spacing(const Points& points);

// Whether the points lie in one layer, near a plane: their standard deviation across it is less
// than half their spacing.
bool IsSheet(const Points& points);

// The points of a sheet, joined by Delaunay triangles of the plane; those that bridge gaps (an edge
// longer than 4 spacings) are left out. Both sides: each vertex and face is there twice, the second
// time turned around, because MuJoCo draws skins from one side.
TriangleMesh SheetSurface(const Points& points);

// A closed surface around the points: `radius` away from single ones and from layers, through the
// outermost ones of a solid. It is where
//   | x - mean(x_i) | - radius = 0
// with the mean over the points near x, weighted by distance (Zhu and Bridson, Animating Sand as a
// Fluid, 2005). Cavities inside are filled. By naive surface nets: one vertex in each cell of a
// grid that the surface goes through.
TriangleMesh ClosedSurface(const Points& points, double radius);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_SURFACE_H_
