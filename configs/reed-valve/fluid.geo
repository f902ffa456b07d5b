// SPDX-License-Identifier: Apache-2.0
// Half (y >= 0) of the reed valve of [thesis] 4.5: a feeding tube below (z < 0), the seat (z = 0), the reed at a lift
// of `lift`, and a chamber between the seat and a parallel plate. Layers of hexahedra (a few prisms) over one plan.
// The reed's outline is that of configs/plate-reed, 0.97 mm shorter: 31.4 Hz, as measured in the rig.
DefineConstant[ size = 1.6e-3, growth = 1.2, n_gap = 3, lift = 0.1e-3 ]; // m: cells on the reed; of the layers; cells across the gap; gap at rest
mm = 1e-3;
D = 45.37 * mm; R = D / 2; w = 7.24 * mm; xc = 53.34 * mm; F = 23.42 * mm; Q = 12.86 * mm; // the outline
d = 34.9 * mm; length = 3 * d; thickness = 0.4 * mm; top = 20 * mm; radius = 110 * mm;
near = size; edge = 0.7 * size; far = 6 * size;

fy = w / 2 + F; fx = xc - Sqrt((R + F)^2 - fy^2);
qy = w / 2 + Q; qx = Q;
tx = xc - (xc - fx) * R / (R + F); ty = fy * R / (R + F);

Point(1) = {xc - radius, 0, 0, far};
Point(2) = {0, 0, 0, near};
Point(3) = {xc - d / 2, 0, 0, edge};
Point(4) = {xc + d / 2, 0, 0, edge};
Point(5) = {xc + R, 0, 0, edge};
Point(6) = {xc + radius, 0, 0, far};
Point(7) = {xc, radius, 0, far};
Point(8) = {xc, d / 2, 0, edge};
Point(9) = {xc, 0, 0, 1.5 * size};
Point(10) = {0, qy, 0, (near > 3.2e-3) ? near : 3.2e-3}; // the fillet is tangent to the clamp: short edges make slivers in its corner
Point(11) = {qx, w / 2, 0, near};
Point(12) = {fx, w / 2, 0, edge};
Point(13) = {tx, ty, 0, edge};
Point(14) = {qx, qy, 0, near};
Point(15) = {fx, fy, 0, near};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 9};
Line(4) = {9, 4};
Line(5) = {4, 5};
Line(6) = {5, 6};
Circle(7) = {6, 9, 7};
Circle(8) = {7, 9, 1};
Circle(9) = {4, 9, 8};
Circle(10) = {8, 9, 3};
Circle(11) = {5, 9, 13};
Circle(12) = {13, 15, 12};
Line(13) = {12, 11};
Circle(14) = {11, 14, 10};
Line(15) = {10, 2};
Curve Loop(1) = {3, 4, 9, 10};                     // the orifice
Curve Loop(2) = {2, -10, -9, 5, 11, 12, 13, 14, 15}; // the rest of the reed
Curve Loop(3) = {1, -15, -14, -13, -12, -11, 6, 7, 8}; // beside the reed
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Plane Surface(3) = {3};
Recombine Surface {1, 2, 3};

// Layers grow by `growth` away from the gap: down the tube from `lift`, up the chamber from the reed's thickness.
up_n() = {}; up_z() = {}; down_n() = {}; down_z() = {};
height = top - lift - thickness;
n_up = Round(Log(1 + height * (growth - 1) / thickness) / Log(growth));
n_tube = Round(Log(1 + length * (growth - 1) / lift) / Log(growth));
For i In {1 : n_up}
  up_n() += {1}; up_z() += {(growth^i - 1) / (growth^n_up - 1)};
EndFor
For i In {1 : n_tube}
  down_n() += {1}; down_z() += {(growth^i - 1) / (growth^n_tube - 1)};
EndFor

volumes() = {}; plate() = {}; seat() = {}; walls() = {}; outlet() = {}; middle() = {};
tube() = Extrude {0, 0, -length} { Surface {1}; Layers {down_n(), down_z()}; Recombine; };
volumes() += {tube(1)}; inlet() = {tube(0)}; middle() += {tube(2), tube(3)}; walls() += {tube(4), tube(5)};
seat() = {2, 3};
For k In {1 : 3}
  gap() = Extrude {0, 0, lift} { Surface {k}; Layers {n_gap}; Recombine; };
  volumes() += {gap(1)};
  If (k == 1) middle() += {gap(2), gap(3)}; plate() += {gap(0)}; EndIf
  If (k == 2) middle() += {gap(2), gap(5)}; plate() += {gap(0)}; EndIf
  If (k == 3) middle() += {gap(2), gap(8)}; outlet() += {gap(9), gap(10)}; beside = gap(0); EndIf
EndFor
rim() = Extrude {0, 0, thickness} { Surface {beside}; Layers {1}; Recombine; };
volumes() += {rim(1)}; middle() += {rim(2), rim(8)}; outlet() += {rim(9), rim(10)};
walls() += {rim(3)}; plate() += {rim(4), rim(5), rim(6), rim(7)};
// the reed's upper face, with a mesh of its own inside the outline
edges() = Boundary { Surface {rim(0)}; };
from() = Boundary { Curve {Abs(edges(0))}; };
to() = Boundary { Curve {Abs(edges(6))}; };
ridge = newl;
Line(ridge) = {from(1), to(0)};
loop = newll;
Curve Loop(loop) = {ridge, -edges(5), -edges(4), -edges(3), -edges(2), -edges(1)};
upper = news;
Plane Surface(upper) = {loop};
Recombine Surface {upper};
plate() += {upper};
over() = Extrude {0, 0, top - lift - thickness} { Surface {upper}; Layers {up_n(), up_z()}; Recombine; };
volumes() += {over(1)}; middle() += {over(2)}; walls() += {over(0)};
over() = Extrude {0, 0, top - lift - thickness} { Surface {rim(0)}; Layers {up_n(), up_z()}; Recombine; };
volumes() += {over(1)}; middle() += {over(2), over(8)}; walls() += {over(0)}; outlet() += {over(9), over(10)};

Physical Surface("inlet") = {inlet()};
Physical Surface("outlet") = {outlet()};
Physical Surface("walls") = {walls()};
Physical Surface("seat") = {seat()};
Physical Surface("plate") = {plate()};
Physical Surface("middle") = {middle()};
Physical Volume("fluid") = {volumes()};
