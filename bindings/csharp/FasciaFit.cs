// Live fitting for C#: activations and the head's pose from a stream of landmarks. Belongs to Fascia.cs.
using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Fascia
{
    internal static partial class Native
    {
        [StructLayout(LayoutKind.Sequential)]
        public struct FitLandmarks
        {
            public uint StructSize, Count;
            public IntPtr Set, Names, Places;
        }
        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct FitOptions
        {
            public uint StructSize;
            public int Level, Iterations, FindsScale;
            public float Ridge, Sparsity, Smoothness;
            public fixed float Focal[2], Centre[2];
        }
        [StructLayout(LayoutKind.Sequential)]
        public struct FitInfo
        {
            public uint StructSize, PointCount, Dimensions, LandmarkCount;
            public IntPtr Names;
        }
        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct FitResult
        {
            public uint StructSize, Seen;
            public float Residual, Scale;
            public fixed float Head[16];
            public IntPtr Values, Landmarks;
        }

        [DllImport(Library)] public static extern FitOptions fascia_default_fit_options();
        [DllImport(Library)] public static extern int fascia_fit_create(IntPtr asset, ref FitLandmarks landmarks, ref FitOptions options, out IntPtr fit);
        [DllImport(Library)] public static extern void fascia_fit_release(IntPtr fit);
        [DllImport(Library)] public static extern int fascia_fit_get_info(IntPtr fit, ref FitInfo info);
        [DllImport(Library)] public static extern unsafe int fascia_fit_set_neutral(IntPtr fit, float* points, float* weights);
        [DllImport(Library)] public static extern unsafe int fascia_fit_push(IntPtr fit, float* points, float* weights, ref FitResult result);
        [DllImport(Library)] public static extern int fascia_fit_reset(IntPtr fit);
    }

    /// From a stream of landmarks to muscles. `set` is a detector's mark-up, "ibug68" or "mediapipe478". For one thread at a time.
    public sealed unsafe class Fit : IDisposable
    {
        IntPtr handle;
        Native.FitResult result;
        readonly float[] head = new float[16];
        public int PointCount { get; private set; }
        public int Dimensions { get; private set; }
        public int LandmarkCount { get; private set; }

        public Fit(Asset asset, string set = "ibug68", int level = 0)
        {
            var options = Native.fascia_default_fit_options();
            options.Level = level;
            byte[] name = Encoding.UTF8.GetBytes(set + "\0");
            fixed (byte* text = name)
            {
                var landmarks = new Native.FitLandmarks { StructSize = Native.Size<Native.FitLandmarks>(), Set = (IntPtr)text };
                Native.Check(Native.fascia_fit_create(asset.Handle, ref landmarks, ref options, out handle));
            }
            var info = new Native.FitInfo { StructSize = Native.Size<Native.FitInfo>() };
            Native.Check(Native.fascia_fit_get_info(handle, ref info));
            PointCount = (int)info.PointCount;
            Dimensions = (int)info.Dimensions;
            LandmarkCount = (int)info.LandmarkCount;
            result.StructSize = Native.Size<Native.FitResult>();
        }
        ~Fit() { Native.fascia_fit_release(handle); }
        public void Dispose() { Native.fascia_fit_release(handle); handle = IntPtr.Zero; GC.SuppressFinalize(this); }

        void CheckSizes(float[] points, float[] weights)
        {
            if (points.Length != PointCount * Dimensions || (weights != null && weights.Length != PointCount))
                throw new ArgumentException("a frame has " + PointCount + " points of " + Dimensions + " numbers");
        }
        /// A frame of the same face at rest.
        public void SetNeutral(float[] points, float[] weights = null)
        {
            CheckSizes(points, weights);
            fixed (float* data = points, seen = weights) Native.Check(Native.fascia_fit_set_neutral(handle, data, seen));
        }
        /// The next frame, NaN where a point is not seen. How many landmarks counted.
        public int Push(float[] points, float[] weights = null)
        {
            CheckSizes(points, weights);
            fixed (float* data = points, seen = weights) Native.Check(Native.fascia_fit_push(handle, data, seen, ref result));
            fixed (float* matrix = result.Head)
                for (int i = 0; i < 16; ++i) head[i] = matrix[i];
            return (int)result.Seen;
        }
        public void Reset() { Native.Check(Native.fascia_fit_reset(handle)); }

        /// What the last frame told: metres left between points and face; the head as a matrix, column-major; a value a channel and
        /// three numbers a landmark in the library's memory, until the next frame.
        public float Residual => result.Residual;
        public float Scale => result.Scale;
        public float[] Head => head;
        public float* Values => (float*)result.Values;
        public float* Landmarks => (float*)result.Landmarks;
    }
}
