// SPDX-License-Identifier: Apache-2.0
// The plate of configs/turek-hron with the faces of the fluid's mesh (configs/cfd3/channel.geo) on its sides and at its end.
DefineConstant[ n = 12 ];
n_ring = Round(1.5 * n); n_plate = Round(1.92 * n); n_tip = Round(0.5 * n);
g = 5 ^ (1 / n_ring);
g_plate = (1 / 3) ^ (1 / (n_plate - 1));
c = 0.2; r = 0.05; h = 0.01; s = 0.085; f = Sqrt(r ^ 2 - h ^ 2);
Point(1) = {c + f, c - h, 0}; Point(2) = {c + s, c - h, 0}; Point(3) = {0.6, c - h, 0};
Point(4) = {0.6, c + h, 0}; Point(5) = {c + s, c + h, 0}; Point(6) = {c + f, c + h, 0};
Point(7) = {c, c, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {5, 4}; Line(5) = {6, 5}; Line(6) = {2, 5};
Circle(7) = {1, 7, 6};
Transfinite Curve {1, 5} = n_ring + 1 Using Progression g;
Transfinite Curve {2, 4} = n_plate + 1 Using Progression g_plate;
Transfinite Curve {3, 6, 7} = n_tip + 1;
Curve Loop(1) = {1, 6, -5, -7};
Curve Loop(2) = {2, 3, -4, -6};
Plane Surface(1) = {1}; Plane Surface(2) = {2};
Transfinite Surface {1}; Transfinite Surface {2};
Recombine Surface {1, 2};
Physical Curve("root") = {7};
Physical Curve("plate") = {1 : 5};
Physical Surface("solid") = {1, 2};
