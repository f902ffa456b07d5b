// SPDX-License-Identifier: Apache-2.0
// The flap. Its cells along the sides and the tip halve those of fluid.geo, because
// the operator needs short cells along a beam to bend it right; every vertex of the fluid has its twin here.
DefineConstant [
  n_side = 160, // cells along each side
  n_tip = 16    // cells across the tip
];

half = 0.05; height = 1; // m

Point(1) = {-half, 0, 0};
Point(2) = {half, 0, 0};
Point(3) = {half, height, 0};
Point(4) = {-half, height, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1, 3} = n_tip + 1;
Transfinite Curve {2, 4} = n_side + 1;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};

Physical Curve("root") = {1};
Physical Curve("flap") = {2, 3, 4};
Physical Surface("solid") = {1};
