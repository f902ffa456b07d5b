// SPDX-License-Identifier: Apache-2.0
DefineConstant[ n = 32 ];
q=n/4; m=Round(0.75*n); g=80^(1/m);
Point(1)={0,0,0};
For i In {0:3}
  a=Pi/4+i*Pi/2;
  Point(10+i)={0.5*Cos(a),0.5*Sin(a),0}; Point(20+i)={30*Cos(a),30*Sin(a),0};
EndFor
For i In {0:3}
  j=(i+1)%4;
  Circle(10+i)={10+i,1,10+j}; Circle(20+i)={20+i,1,20+j}; Line(30+i)={10+i,20+i};
  Transfinite Curve{10+i,20+i}=q+1; Transfinite Curve{30+i}=m+1 Using Progression g;
EndFor
For i In {0:3}
  j=(i+1)%4;
  Curve Loop(40+i)={10+i,30+j,-(20+i),-(30+i)}; Plane Surface(40+i)={40+i}; Transfinite Surface{40+i}; Recombine Surface{40+i};
EndFor
Physical Curve("cylinder")={10:13}; Physical Curve("out")={23}; Physical Curve("in")={20:22}; Physical Surface("fluid")={40:43};
