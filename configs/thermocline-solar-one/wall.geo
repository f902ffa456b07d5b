// SPDX-License-Identifier: Apache-2.0
// A thin wedge of the tank's wall between two symmetry planes: six plates, 400 x 3 cells; between plates of different
// thickness one cell of changing thickness.
nr = 3;
dz = 0.035; // m, height of a cell
angle = 0.0002; // of the wedge, so that a cell is not longer around the tank than through the wall
radius = 9.1; // m, inner
thickness[] = {0.0286, 0.019, 0.0156, 0.0095, 0.0079, 0.019}; // m, from the bottom up
top[] = {1.8, 4.66, 7.52, 10.38, 13.24, 14}; // m
c = Cos(angle / 2); s = -Sin(angle / 2);
// Heights where the outline bends: half a cell below and above each joint.
z[] = {0}; e[] = {thickness[0]};
For k In {0 : 4}
  z[] += {top[k] - dz / 2, top[k] + dz / 2};
  e[] += {thickness[k], thickness[k + 1]};
EndFor
z[] += {top[5]}; e[] += {thickness[5]};
n = #z[];
For i In {0 : n - 1}
  Point(2 * i + 1) = {radius * c, radius * s, z[i]};
  Point(2 * i + 2) = {(radius + e[i]) * c, (radius + e[i]) * s, z[i]};
  Line(1000 + i) = {2 * i + 1, 2 * i + 2};
  Transfinite Curve {1000 + i} = nr + 1;
EndFor
inside[] = {}; outside[] = {}; front[] = {}; back[] = {}; wall[] = {};
For i In {0 : n - 2}
  Line(2000 + i) = {2 * i + 2, 2 * i + 4};
  Line(3000 + i) = {2 * i + 1, 2 * i + 3};
  cells = Round((z[i + 1] - z[i]) / dz);
  Transfinite Curve {2000 + i, 3000 + i} = cells + 1;
  Curve Loop(i + 1) = {1000 + i, 2000 + i, -(1001 + i), -(3000 + i)};
  Plane Surface(i + 1) = {i + 1};
  Transfinite Surface {i + 1};
  Recombine Surface {i + 1};
EndFor
For i In {0 : n - 2}
  out[] = Extrude {{0, 0, 1}, {0, 0, 0}, angle} {Surface{i + 1}; Layers{1}; Recombine;};
  front[] += {i + 1}; back[] += {out[0]}; wall[] += {out[1]};
  If (i == 0)
    bottom = out[2];
  EndIf
  If (i == n - 2)
    lid = out[4];
  EndIf
  outside[] += {out[3]}; inside[] += {out[5]};
EndFor
Physical Surface("side-a") = front[];
Physical Surface("side-b") = back[];
Physical Surface("bottom") = {bottom};
Physical Surface("top") = {lid};
Physical Surface("inside") = inside[];
Physical Surface("outside") = outside[];
Physical Volume("wall") = wall[];
