// SPDX-License-Identifier: Apache-2.0
// Quarter of a square plate of 10 m x 10 m x 1 m; its centre is at the origin, the mid-plane is z = 0.
DefineConstant [
  n = 60,  // cells along each half side
  nz = 11  // cells over the thickness; an odd number has a row of faces at mid-thickness
];
half = 5; thickness = 1; // m
Point(1) = {0, 0, -thickness / 2};
Point(2) = {half, 0, -thickness / 2};
Point(3) = {half, half, -thickness / 2};
Point(4) = {0, half, -thickness / 2};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1 : 4} = n + 1;
Curve Loop(1) = {1 : 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
out() = Extrude {0, 0, thickness} { Surface {1}; Layers {nz}; Recombine; };
Physical Surface("bottom") = {1};
Physical Surface("top") = {out(0)};
Physical Surface("symmetry-y") = {out(2)};
Physical Surface("edge-x") = {out(3)};
Physical Surface("edge-y") = {out(4)};
Physical Surface("symmetry-x") = {out(5)};
Physical Volume("plate") = {out(1)};
