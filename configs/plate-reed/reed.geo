// SPDX-License-Identifier: Apache-2.0
// The reed of a valve: a disc on a neck that is clamped at x = 0. The outline is the fit of the thesis's table of
// frequencies (4.1): neck 7.24 mm wide, 54.31 mm from clamp to disc centre, fillets of 23.42 mm to the disc and of
// 12.86 mm at the root.
DefineConstant[ size = 2e-3 ]; // m; of the triangles
mm = 1e-3;
D = 45.37 * mm; R = D / 2; w = 7.24 * mm; xc = 54.31 * mm; F = 23.42 * mm; Q = 12.86 * mm;

// Centres of the fillets: to the disc (tangent to it and to the neck's edge), at the root (tangent to the neck's edge
// and to the clamp line's normal).
fy = w / 2 + F; fx = xc - Sqrt((R + F)^2 - fy^2);
qy = w / 2 + Q; qx = Q;
// Where the fillet touches the disc.
tx = xc - (xc - fx) * R / (R + F); ty = fy * R / (R + F);

Point(1) = {0, -qy, 0, size};
Point(2) = {qx, -w / 2, 0, size};
Point(3) = {fx, -w / 2, 0, size};
Point(4) = {tx, -ty, 0, size};
Point(5) = {xc + R, 0, 0, size};
Point(6) = {tx, ty, 0, size};
Point(7) = {fx, w / 2, 0, size};
Point(8) = {qx, w / 2, 0, size};
Point(9) = {0, qy, 0, size};
Point(10) = {qx, -qy, 0, size};
Point(11) = {fx, -fy, 0, size};
Point(12) = {xc, 0, 0, size};
Point(13) = {fx, fy, 0, size};
Point(14) = {qx, qy, 0, size};
Circle(1) = {1, 10, 2};
Line(2) = {2, 3};
Circle(3) = {3, 11, 4};
Circle(4) = {4, 12, 5};
Circle(5) = {5, 12, 6};
Circle(6) = {6, 13, 7};
Line(7) = {7, 8};
Circle(8) = {8, 14, 9};
Line(9) = {9, 1};
Curve Loop(1) = {1 : 9};
Plane Surface(1) = {1};
Physical Curve("clamp") = {9};
Physical Curve("edge") = {1 : 8};
Physical Surface("reed") = {1};
