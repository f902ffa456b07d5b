// SPDX-License-Identifier: Apache-2.0
// A thin wedge of a hollow cylinder, one cell wide, between two symmetry planes: the way to an axisymmetric scene.
DefineConstant [
  nr = 20, // cells through the wall
  nz = 2   // cells along the axis
];
inner = 1; outer = 1.5; height = 0.2; // m
angle = 0.002; // of the wedge: its curvature is kept to angle^2
c = Cos(angle / 2); s = -Sin(angle / 2);
Point(1) = {inner * c, inner * s, 0};
Point(2) = {outer * c, outer * s, 0};
Point(3) = {outer * c, outer * s, height};
Point(4) = {inner * c, inner * s, height};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1, 3} = nr + 1;
Transfinite Curve {2, 4} = nz + 1;
Curve Loop(1) = {1 : 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
wedge[] = Extrude {{0, 0, 1}, {0, 0, 0}, angle} {Surface{1}; Layers{1}; Recombine;};
Physical Surface("side-a") = {1};
Physical Surface("side-b") = {wedge[0]};
Physical Surface("bottom") = {wedge[2]};
Physical Surface("outside") = {wedge[3]};
Physical Surface("top") = {wedge[4]};
Physical Surface("inside") = {wedge[5]};
Physical Volume("wall") = {wedge[1]};
