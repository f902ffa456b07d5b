// SPDX-License-Identifier: Apache-2.0
// Half of a reed in a chamber: a plate 60 x 20 x 0.4 mm, clamped at x = 0, 0.3 mm above the seat; tetrahedra of 1 mm at its edges.
SetFactory("OpenCASCADE");
DefineConstant[ edge = 1 ];  // [mm]
mm = 1e-3; e = 1e-5;
Box(1) = {0, 0, 0, 90 * mm, 20 * mm, 20 * mm};
Box(2) = {-1 * mm, -1 * mm, 0.3 * mm, 61 * mm, 11 * mm, 0.4 * mm};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
plate() = Surface In BoundingBox {-e, -e, 0.3 * mm - e, 60 * mm + e, 10 * mm + e, 0.7 * mm + e};
Physical Surface("plate") = {plate()};
Physical Surface("seat") = Surface In BoundingBox {-e, -e, -e, 90 * mm + e, 20 * mm + e, e};
Physical Surface("lid") = Surface In BoundingBox {-e, -e, 20 * mm - e, 90 * mm + e, 20 * mm + e, 20 * mm + e};
Physical Surface("far") = Surface In BoundingBox {90 * mm - e, -e, -e, 90 * mm + e, 20 * mm + e, 20 * mm + e};
Physical Surface("side") = Surface In BoundingBox {-e, 20 * mm - e, -e, 90 * mm + e, 20 * mm + e, 20 * mm + e};
Physical Surface("clamp") = Surface In BoundingBox {-e, -e, -e, e, 20 * mm + e, 20 * mm + e};
Physical Surface("middle") = Surface In BoundingBox {-e, -e, -e, 90 * mm + e, e, 20 * mm + e};
Physical Volume("fluid") = {3};
rim() = Curve In BoundingBox {-e, -e, 0.3 * mm - e, 60 * mm + e, 10 * mm + e, 0.7 * mm + e};
MeshSize{:} = 5 * mm;
MeshSize{ PointsOf{ Surface{plate()}; } } = edge * mm;
Field[1] = Distance;
Field[1].CurvesList = {rim()};
Field[1].NumPointsPerCurve = 120;
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = edge * mm; Field[2].SizeMax = 4 * mm;
Field[2].DistMin = 1 * mm; Field[2].DistMax = 15 * mm;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;
