// SPDX-License-Identifier: Apache-2.0
// Box 4 x 2 x 1 with a flap 0.1 thick, 1 high and 0.5 deep on its floor, against its front; hexahedra.
DefineConstant[ n = 10 ];  // cells along the height of the flap
x() = {0, 1.95, 2.05, 4};
y() = {0, 1, 2};
z() = {0, 0.5, 1};
For k In {0 : 2}
  For j In {0 : 2}
    For i In {0 : 3}
      Point(1 + i + 4 * j + 12 * k) = {x(i), y(j), z(k)};
    EndFor
  EndFor
EndFor
nx() = {2 * n, Ceil(n / 5), 2 * n};
For k In {0 : 2}
  For j In {0 : 2}
    For i In {0 : 2}
      Line(100 + i + 4 * j + 12 * k) = {1 + i + 4 * j + 12 * k, 2 + i + 4 * j + 12 * k};
      Transfinite Curve {100 + i + 4 * j + 12 * k} = nx(i) + 1;
    EndFor
  EndFor
EndFor
For k In {0 : 2}
  For j In {0 : 1}
    For i In {0 : 3}
      Line(200 + i + 4 * j + 12 * k) = {1 + i + 4 * j + 12 * k, 5 + i + 4 * j + 12 * k};
      Transfinite Curve {200 + i + 4 * j + 12 * k} = n + 1;
    EndFor
  EndFor
EndFor
For k In {0 : 1}
  For j In {0 : 2}
    For i In {0 : 3}
      Line(300 + i + 4 * j + 12 * k) = {1 + i + 4 * j + 12 * k, 13 + i + 4 * j + 12 * k};
      Transfinite Curve {300 + i + 4 * j + 12 * k} = Ceil(n / 2) + 1;
    EndFor
  EndFor
EndFor
For k In {0 : 2}
  For j In {0 : 1}
    For i In {0 : 2}
      Curve Loop(400 + i + 4 * j + 12 * k) = {100 + i + 4 * j + 12 * k, 201 + i + 4 * j + 12 * k, -(104 + i + 4 * j + 12 * k), -(200 + i + 4 * j + 12 * k)};
      Plane Surface(400 + i + 4 * j + 12 * k) = {400 + i + 4 * j + 12 * k};
    EndFor
  EndFor
EndFor
For k In {0 : 1}
  For j In {0 : 2}
    For i In {0 : 2}
      Curve Loop(500 + i + 4 * j + 12 * k) = {100 + i + 4 * j + 12 * k, 301 + i + 4 * j + 12 * k, -(112 + i + 4 * j + 12 * k), -(300 + i + 4 * j + 12 * k)};
      Plane Surface(500 + i + 4 * j + 12 * k) = {500 + i + 4 * j + 12 * k};
    EndFor
  EndFor
  For j In {0 : 1}
    For i In {0 : 3}
      Curve Loop(600 + i + 4 * j + 12 * k) = {200 + i + 4 * j + 12 * k, 304 + i + 4 * j + 12 * k, -(212 + i + 4 * j + 12 * k), -(300 + i + 4 * j + 12 * k)};
      Plane Surface(600 + i + 4 * j + 12 * k) = {600 + i + 4 * j + 12 * k};
    EndFor
  EndFor
EndFor
all() = Surface "*";
Transfinite Surface {all()};
Recombine Surface {all()};
For k In {0 : 1}
  For j In {0 : 1}
    For i In {0 : 2}
      If (!(i == 1 && j == 0 && k == 0))
        Surface Loop(700 + i + 4 * j + 12 * k) = {400 + i + 4 * j + 12 * k, 412 + i + 4 * j + 12 * k, 500 + i + 4 * j + 12 * k, 504 + i + 4 * j + 12 * k, 600 + i + 4 * j + 12 * k, 601 + i + 4 * j + 12 * k};
        Volume(700 + i + 4 * j + 12 * k) = {700 + i + 4 * j + 12 * k};
        Transfinite Volume {700 + i + 4 * j + 12 * k};
      EndIf
    EndFor
  EndFor
EndFor
volumes() = Volume "*";
Physical Volume("fluid") = {volumes()};
Physical Surface("flap") = {601, 602, 505, 413};
Physical Surface("floor") = {500, 502, 512, 513, 514};
Physical Surface("front") = {400, 402, 404, 405, 406};
Physical Surface("back") = {424 : 426, 428 : 430};
Physical Surface("lid") = {508 : 510, 520 : 522};
Physical Surface("ends") = {600, 604, 612, 616, 603, 607, 615, 619};
