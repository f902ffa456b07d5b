// SPDX-License-Identifier: Apache-2.0
// Half of the flap of fluid-3d.geo, with the same faces.
DefineConstant [
  n_side = 10,  // cells along each side
  n_tip = 2,    // cells across the tip
  n_width = 3   // cells across half the width
];

half = 0.05; height = 1; width = 1; // m

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
e() = Extrude {0, 0, width / 2} { Surface{1}; Layers{n_width}; Recombine; };

Physical Surface("middle") = {1};
Physical Surface("root") = {e(2)};
Physical Surface("flap") = {e(0), e(3), e(4), e(5)};
Physical Volume("solid") = {e(1)};
