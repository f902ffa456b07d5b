// SPDX-License-Identifier: Apache-2.0
// Half of the reed (y >= 0), its mid-surface at z = 0: same outline as in fluid.geo.
DefineConstant[ size = 1.6e-3 ]; // m; of the triangles
mm = 1e-3;
D = 45.37 * mm; R = D / 2; w = 7.24 * mm; xc = 53.34 * mm; F = 23.42 * mm; Q = 12.86 * mm;
fy = w / 2 + F; fx = xc - Sqrt((R + F)^2 - fy^2);
qy = w / 2 + Q; qx = Q;
tx = xc - (xc - fx) * R / (R + F); ty = fy * R / (R + F);
Point(1) = {0, 0, 0, size};
Point(2) = {xc + R, 0, 0, size};
Point(3) = {tx, ty, 0, size};
Point(4) = {fx, w / 2, 0, size};
Point(5) = {qx, w / 2, 0, size};
Point(6) = {0, qy, 0, size};
Point(7) = {xc, 0, 0, size};
Point(8) = {fx, fy, 0, size};
Point(9) = {qx, qy, 0, size};
Line(1) = {1, 2};
Circle(2) = {2, 7, 3};
Circle(3) = {3, 8, 4};
Line(4) = {4, 5};
Circle(5) = {5, 9, 6};
Line(6) = {6, 1};
Curve Loop(1) = {1 : 6};
Plane Surface(1) = {1};
Physical Curve("middle") = {1};
Physical Curve("edge") = {2 : 5};
Physical Curve("clamp") = {6};
Physical Surface("reed") = {1};
