// SPDX-License-Identifier: Apache-2.0
// Channel 4 pi x 2 x 4 pi / 3 between walls at y = 0 and y = 2, finer towards them.
DefineConstant[ nx = 64, ny = 64, nz = 64 ];
lx = 4 * Pi; lz = 4 * Pi / 3;
Point(1) = {0, 0, 0};
Point(2) = {lx, 0, 0};
Point(3) = {lx, 2, 0};
Point(4) = {0, 2, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1, 3} = nx + 1;
Transfinite Curve {2, 4} = ny + 1 Using Bump 0.08;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
v() = Extrude {0, 0, lz} { Surface{1}; Layers{nz}; Recombine; };
Physical Surface("back") = {1};
Physical Surface("front") = {v(0)};
Physical Surface("floor") = {v(2)};
Physical Surface("right") = {v(3)};
Physical Surface("ceiling") = {v(4)};
Physical Surface("left") = {v(5)};
Physical Volume("fluid") = {v(1)};
