//! stub
use crate::blob::format::*;
use crate::real::*;
use crate::spectrum::Spectrum;
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode { Radiance, Importance }
impl Mode { pub fn reversed(self)->Self { match self { Mode::Radiance=>Mode::Importance, _=>Mode::Radiance } } }
#[derive(Clone, Copy, Debug)]
pub struct TextureView<'a> { pub textures: &'a [Texture], pub texels: &'a [u32] }
#[derive(Clone, Copy, Debug)]
pub struct Scatter<S> { pub wi: Vec3, pub weight: S, pub pdf: Real, pub pdf_reverse: Real, pub dirac: bool, pub transmitted: bool, pub eta_scale: Real }
#[derive(Clone, Copy, Debug)]
pub enum Surface<S> { D(S), M(S), G(Real) }
impl<S: Spectrum> Surface<S> {
 pub const BLACK: Self = Surface::D(S::BLACK);
 pub fn resolve(m: &Material, _: TextureView<'_>, _: [Real;2]) -> Self { match m.kind { 0 => Surface::D(S::from_rgb(m.color[0])), 3 => Surface::G(m.ior as Real), _ => Surface::M(S::from_rgb(m.color[0])) } }
 pub fn has_smooth(&self)->bool { matches!(self, Surface::D(s) if !s.is_black()) }
 #[inline(always)]
 pub fn eval(&self, wo: Vec3, wi: Vec3)->S { match self { Surface::D(k) if wo.z*wi.z>0.0 => *k*INV_PI, _=>S::BLACK } }
 #[inline(always)]
 pub fn pdf(&self, w: Vec3, wi: Vec3, _:Mode)->Real { match self { Surface::D(_) if w.z*wi.z>0.0 => wi.z.abs()*INV_PI, _=>0.0 } }
 #[inline(always)]
 pub fn sample(&self, w: Vec3, mode: Mode, lobe: Real, xi:[Real;2])->Option<Scatter<S>> { match self {
  Surface::D(k) => { if k.is_black() {return None}; let mut wi=crate::warp::cosine_hemisphere(xi); if w.z<0.0 {wi.z=-wi.z}; Some(Scatter{wi,weight:*k,pdf:wi.z.abs()*INV_PI,pdf_reverse:w.z.abs()*INV_PI,dirac:false,transmitted:false,eta_scale:1.0}) }
  Surface::M(k) => Some(Scatter{wi:Vec3::new(-w.x,-w.y,w.z),weight:*k,pdf:1.0,pdf_reverse:1.0,dirac:true,transmitted:false,eta_scale:1.0}),
  Surface::G(ior) => { let (eta,ci)=(if w.z>0.0 {*ior} else {1.0/ *ior}, w.z.abs()); let s2=(1.0-ci*ci)/(eta*eta);
    let (r,ct)= if s2>=1.0 {(1.0,0.0)} else { let ct=sqrt(1.0-s2); let a=(ci-eta*ct)/(ci+eta*ct); let b=(eta*ci-ct)/(eta*ci+ct); (0.5*(a*a+b*b),ct)};
    if lobe<r { Some(Scatter{wi:Vec3::new(-w.x,-w.y,w.z),weight:S::WHITE,pdf:r,pdf_reverse:r,dirac:true,transmitted:false,eta_scale:1.0}) }
    else { let k=if mode==Mode::Radiance {1.0/(eta*eta)} else {1.0}; Some(Scatter{wi:Vec3::new(-w.x/eta,-w.y/eta,-w.z.signum()*ct),weight:S::grey(k),pdf:1.0-r,pdf_reverse:1.0-r,dirac:true,transmitted:true,eta_scale:k}) } }
 } }
}
pub fn opacity(_: TextureView<'_>, _: u32, _: [Real;2])->Real { 1.0 }
